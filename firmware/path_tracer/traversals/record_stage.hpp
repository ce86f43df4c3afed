#pragma once

#include "firmware/path_tracer/stages/transfer_ring.hpp"
#include "firmware/path_tracer/traversals/tree_stage.hpp"

/// What the ways have in common that keep rays in mono memory between their turns: their records travel.
namespace path_tracer {

/// Records of rays in SRAM. A buffer stays a step's from the load, which is begun two steps of n ahead since
/// a ray's leaf is known only when the ray is there, to the end of the save.
class RecordRing {
 public:
  RecordRing(cn::Machine& machine, const ProgramConfig& config);
  static int buffers(const ProgramConfig& config);

  PolyPointer<TraversalRecord> record(std::uint64_t step) const {
    return PolyPointer<TraversalRecord>(ring_.buffer(step));
  }
  /// Where each PE's record is saved.
  PolyField<MonoAddress> record_to(std::uint64_t step) const {
    return {ring_.buffer(step).offset_bytes + record_bytes_};
  }
  int record_bytes() const { return record_bytes_; }

  void wait(std::uint64_t step) { ring_.wait(step); }
  /// Of records that lie side by side, after the step that saved the last of them.
  void load(std::uint64_t step, MonoAddress first, std::uint64_t last_writer, const LaneMask& rays);
  void save(std::uint64_t step, const LaneMask& rays);

 private:
  cn::PolySpan span(std::uint64_t step) const { return {ring_.buffer(step).offset_bytes, record_bytes_}; }

  cn::Machine& machine_;
  int record_bytes_;
  bool buffers_loads_;
  bool buffers_saves_;
  TransferRing ring_;
};

/// A stage that takes rays through the tree for a turn. Those that are through are done with, the others are
/// put back for another turn.
class RecordStage : public TreeStage {
 public:
  RecordStage(const StageContext& context, TreeContext& tree, RecordRing& records)
      : TreeStage(context, tree), records_(records) {}
  void save(std::uint64_t step, int block) override;

 protected:
  void traverse_and_put_back(std::uint64_t step, const LaneMask& rays, const Needs& needs, std::size_t pass);
  /// Decides where the records of `alive` are saved (RecordRing::record_to).
  virtual void put_back(std::uint64_t step, const LaneMask& rays, const LaneMask& alive,
                        std::size_t pass) = 0;

  RecordRing& records_;

 private:
  LaneMask alive_;
};

/// Ray bin: takes rays as far as the resident nodes go. Its blocks are the ray bin's, packed.
/// @tparam Base a RecordStage, which knows where rays are put
template <class Base>
class BeginStage : public Base {
 public:
  using Base::Base;

  const char* bin() const override { return "ray bin"; }
  void load(std::uint64_t step, int block) override { this->load_packed_rays(step, block); }
  void process(std::uint64_t step, int block) override {
    const LaneMask rays = this->packed_rays(block);
    this->records_.wait(step);
    this->enter(step, this->records_.record(step), rays);
    this->traverse_and_put_back(step, rays, {}, 0);
  }
};

}  // namespace path_tracer
