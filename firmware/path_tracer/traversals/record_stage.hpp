#pragma once

#include "firmware/path_tracer/stages/transfer_ring.hpp"
#include "firmware/path_tracer/traversals/tree_stage.hpp"

/// Shared by the traversals that keep rays in mono memory between their turns: rays' records are loaded and
/// saved.
namespace path_tracer {

/// Records of rays in SRAM. A buffer belongs to a step from its load to the end of its save. The load begins
/// two times n steps ahead, because a ray's leaf is known only when the ray has arrived.
class RecordRing {
 public:
  RecordRing(cn::Machine& machine, const ProgramConfig& config);
  static int buffers(const ProgramConfig& config);

  PolyPointer<TraversalRecord> record(std::uint64_t step) const {
    return PolyPointer<TraversalRecord>(ring_.buffer(step));
  }
  /// Mono address at which each PE's record is saved.
  PolyField<MonoAddress> record_to(std::uint64_t step) const {
    return {ring_.buffer(step).offset_bytes + record_bytes_};
  }
  int record_bytes() const { return record_bytes_; }

  void wait(std::uint64_t step) { ring_.wait(step); }
  /// Loads records that lie side by side, after step `last_writer` has saved the last of them.
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

/// A stage that takes rays through the tree for a turn. It finishes rays at the end of their traversal and
/// puts the others back for another turn.
class RecordStage : public TreeStage {
 public:
  RecordStage(const StageContext& context, TreeContext& tree, RecordRing& records)
      : TreeStage(context, tree), records_(records) {}
  void save(std::uint64_t step, int block) override;

 protected:
  void traverse_and_put_back(std::uint64_t step, const LaneMask& rays, const Needs& needs, std::size_t pass);
  /// Decides where the records of the remaining rays `alive` are saved (RecordRing::record_to).
  virtual void put_back(std::uint64_t step, const LaneMask& rays, const LaneMask& alive,
                        std::size_t pass) = 0;

  RecordRing& records_;

 private:
  LaneMask alive_;
};

/// Begin stage: takes rays from the ray queue as far as the resident nodes go. Its blocks are those of the
/// ray queue.
/// @tparam Base a RecordStage, which decides where rays are put
template <class Base>
class BeginStage : public Base {
 public:
  using Base::Base;

  const char* name() const override { return "begin stage"; }
  void load(std::uint64_t step, int block) override { this->load_packed_rays(step, block); }
  void process(std::uint64_t step, int block) override {
    const LaneMask rays = this->packed_rays(block);
    this->records_.wait(step);
    this->enter(step, this->records_.record(step), rays);
    this->traverse_and_put_back(step, rays, {}, 0);
  }
};

}  // namespace path_tracer
