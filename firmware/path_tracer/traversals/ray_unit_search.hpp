#pragma once

#include "firmware/path_tracer/pipeline/ray_search.hpp"
#include "firmware/path_tracer/traversals/tree_stage.hpp"

/// The search by a unit beside the PE array (cn::SearchFunction), for comparison: the ray processing unit of
/// Woop, Schmittler, Slusallek (SIGGRAPH 2005) divides shading and traversal in the same way. The stages that
/// make rays save them in the unit's buffer, one entry for each slot of the bins; the next pass loads the
/// slots' hits from there. Meanwhile PEs go on with other blocks.
namespace path_tracer {

/// The unit's buffer in place of the ray bin.
class UnitRays : public RayStore {
 public:
  UnitRays(const StageContext& context, cn::MonoAddress first);

  RayRoom take_room(BufferCutter& cutter) const override;
  void save(TransferRing& saves, std::uint64_t step, const RaySlots& slots, const RayRoom& from,
            PolyField<MonoAddress> light_place, const LaneMask& with_ray) override;

  /// The latest step that saved a ray of the block.
  std::uint64_t last_writer(int block) const { return last_writer_[std::size_t(block)]; }

 private:
  cn::Machine& machine_;
  const Kernels& kernels_;
  cn::MonoAddress first_;
  cn::MonoAddress lights_;
  PolyField<std::int32_t> number_;  ///< of each PE
  std::vector<std::uint64_t> last_writer_;
};

class RayUnitSearch : public RaySearch {
 public:
  /// Programs the unit, and lets `layout` point to the hits in its buffer. Throws ProgramError when the
  /// machine has no unit or its buffer does not hold a ray of every slot.
  RayUnitSearch(const StageContext& context, Layout& layout);

  /// Length of bins in blocks whose rays and hits fit the buffer.
  static int most_bin_blocks(const cn::MonoRange& buffer, const RecordSizes& sizes, int num_pes);

  RayStore& rays() override { return rays_; }
  bool has(const Stage& stage) const override { return &stage == &recall_; }
  void add_block(StepPipeline& steps, int block) override { steps.plan(recall_, block); }
  bool begin_pass(StepPipeline& /*steps*/, const std::vector<int>& /*blocks*/) override { return true; }
  bool after_step(StepPipeline& /*steps*/, const Step& /*step*/,
                  const std::vector<int>& /*blocks*/) override {
    return false;
  }

 private:
  UnitRays rays_;
  RecallStage recall_;
};

}  // namespace path_tracer
