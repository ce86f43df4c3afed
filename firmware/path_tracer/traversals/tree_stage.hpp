#pragma once

#include <functional>

#include "firmware/path_tracer/stages/ray_queue.hpp"
#include "firmware/path_tracer/stages/stage.hpp"

/// What all tree traversals share.
namespace path_tracer {

/// The tree in SRAM, the rays that go through it, and counts.
struct TreeContext {
  TreeContext(cn::Machine& machine, const ProgramConfig& config, const Layout& layout, RayQueue& queue);

  RayQueue& queue;
  TreeInSram tree;
  double reach;
  std::uint64_t last_hit_step = 0;  ///< latest step that saved hits
  std::uint64_t finished = 0;       ///< number of the ray queue's rays that are finished
};

/// A stage whose PEs hold rays in the tree.
class TreeStage : public Stage {
 public:
  TreeStage(const StageContext& context, TreeContext& tree)
      : Stage(context), tree_(tree), kernels_(context.kernels.traversal()) {}
  static int save_bytes(const ProgramConfig& config) {
    return RecordSizes(config.features).hit + 3 * int{sizeof(MonoAddress)};
  }
  static int load_bytes(const TreeShape& shape, const Layers& layers);

  bool works_on_slots() const override { return false; }

 protected:
  struct Loads {
    PolyField<MonoAddress> leaf_place;
    PolyField<MonoAddress> treelet_place;
    PolyField<MonoAddress> ray_place;
    PolyField<std::int32_t> treelet;
    PolyPointer<QueuedRay> ray;
    PolyPointer<TriangleRecord> leaf;  ///< in a layered scene of LayeredTriangleRecords
    int treelet_offset;
  };
  Loads loads(std::uint64_t step) const;
  int leaf_bytes() const { return tree_.tree.shape.leaf_records() * context_.layout.layers.record_bytes(); }

  /// Returns the PEs with a ray in a block of the ray queue.
  LaneMask packed_rays(int block) const;
  /// Loads the next block of the ray queue.
  void load_packed_rays(std::uint64_t step, int block);

  /// What rays need of the tree.
  struct Needs {
    LaneMask leaf;
    LaneMask treelet;
    int leaves = 0;
  };
  /// Finds what rays need.
  void locate(std::uint64_t step, PolyPointer<TraversalRecord> record, const LaneMask& rays, Needs& needs);
  void load_leaves(std::uint64_t step, Needs& needs);
  void load_treelets(std::uint64_t step, const Needs& needs);
  /// Finds and loads what rays need.
  void load_tree(std::uint64_t step, PolyPointer<TraversalRecord> record, const LaneMask& rays, Needs& needs);
  /// Makes the TraversalRecords of rays that were loaded.
  void enter(std::uint64_t step, PolyPointer<TraversalRecord> record, const LaneMask& rays);
  /// Takes rays through the tree for a turn. Returns the remaining ones.
  LaneMask traverse(std::uint64_t step, PolyPointer<TraversalRecord> record, const LaneMask& rays,
                    const Needs& needs);
  /// Writes the hits of finished rays; save_hits() saves them.
  void finish(std::uint64_t step, PolyPointer<TraversalRecord> record, const LaneMask& rays);
  void save_hits(std::uint64_t step);
  void count_pass(std::size_t pass, const LaneMask& rays);
  void count_rays(std::size_t pass, std::uint64_t rays) {
    if (context_.counts.traversal.rays.size() <= pass) make_room_for_counts(pass);
    context_.counts.traversal.rays[pass] += rays;
  }
  /// Counts the PEs of a pass, and the rays in them.
  void count_lanes(std::size_t pass, const LaneMask& rays);

  TreeContext& tree_;
  const TraversalKernels& kernels_;

 private:
  struct Hits {
    PolyPointer<HitRecord> hit;
    PolyField<MonoAddress> surface_place;
    PolyField<MonoAddress> hit_to;
    PolyField<MonoAddress> surface_place_to;
  };
  Hits hits(std::uint64_t step) const;
  void make_room_for_counts(std::size_t pass);

  LaneMask finished_;
};

/// Recall stage, between the tree and the intersection stage: brings each slot whether its ray hit something.
class RecallStage : public Stage {
 public:
  /// @param last_writer the latest step whose save the hits of a block's rays need
  RecallStage(const StageContext& context, std::function<std::uint64_t(int block)> last_writer)
      : Stage(context), last_writer_(std::move(last_writer)) {}

  const char* name() const override { return "intersection stage"; }  // whose first half it is
  void load(std::uint64_t step, int block) override;
  void process(std::uint64_t step, int block) override;
  void save(std::uint64_t, int) override {}

 private:
  std::function<std::uint64_t(int block)> last_writer_;
};

}  // namespace path_tracer
