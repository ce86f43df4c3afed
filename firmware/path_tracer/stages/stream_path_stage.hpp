#pragma once

#include "firmware/path_tracer/stages/path_stage.hpp"

namespace path_tracer {

/// The path stage of stream execution. Ascending numbers come from a scan over mono memory (scan_stage.hpp),
/// so the stage is two kernels. The first appends vertices and writes all results back. The second, this
/// stage, loads paths again together with their numbers, which count over all blocks.
class StreamPathStage : public PathStage {
 public:
  StreamPathStage(const StageContext& context, RayStore& rays, const Work& work);
  static int load_bytes(const ProgramConfig& config) {
    return PathStage::load_bytes(config) + int{sizeof(PathNumbers)} + int{sizeof(FinishedRecord)};
  }
  static int save_bytes(const ProgramConfig& config) {
    return PathStage::save_bytes(config) + int{sizeof(PathNumbers)};
  }

  void load(std::uint64_t step, int block) override;
  void process(std::uint64_t step, int block) override;
  void save(std::uint64_t step, int block) override;
  void fill(std::uint64_t step, int block) override;

  class AppendStage : public Stage {
   public:
    AppendStage(const StageContext& context, StreamPathStage& paths) : Stage(context), paths_(paths) {}
    const char* name() const override { return "path stage"; }  // whose first half it is
    void load(std::uint64_t step, int block) override { paths_.load_to_append(step, block); }
    void process(std::uint64_t step, int block) override { paths_.append(step, block); }
    void save(std::uint64_t step, int block) override { paths_.save_appended(step, block); }

   private:
    StreamPathStage& paths_;
  };
  AppendStage& append_stage() { return append_stage_; }

  /// A pass begins. The numbers of its blocks lie side by side, in this order.
  void number_blocks(const std::vector<int>& blocks);
  /// Every path of the pass has its numbers; `total` says how many there are.
  void take_numbers(const PathNumbers& total);
  /// All blocks have their new paths.
  void end_pass() { camera_rays_.issue(std::uint64_t(started_)); }

 private:
  struct Numbered {
    PolyPointer<PathNumbers> numbers;
    PolyPointer<FinishedRecord> finished;
  };
  Numbered numbered(std::uint64_t step) const;
  cn::MonoPlaces number_places(int block) const;
  PolyPointer<PathNumbers> counted(std::uint64_t step) const;
  void load_to_append(std::uint64_t step, int block);
  void append(std::uint64_t step, int block);
  void save_appended(std::uint64_t step, int block);

  AppendStage append_stage_;
  std::vector<int> place_of_block_;  ///< among the blocks of the pass
  std::int32_t started_ = 0;         ///< paths of the pass
};

}  // namespace path_tracer
