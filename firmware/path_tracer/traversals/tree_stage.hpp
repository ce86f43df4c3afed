#pragma once

#include <functional>

#include "firmware/path_tracer/stages/ray_queue.hpp"
#include "firmware/path_tracer/stages/stage.hpp"

/// What the ways through the tree share.
namespace path_tracer {

/// The tree in SRAM, and what is counted.
struct TreeContext {
  TreeContext(cn::Machine& machine, const ProgramConfig& config, const Layout& layout);

  TreeInSram tree;
  double reach;
  std::uint64_t last_hit_step = 0;  ///< the last that saved hits
  std::uint64_t finished = 0;       ///< of the rays that are in the ray bin
};

/// A stage whose PEs hold rays on their way through the tree.
class TreeStage : public Stage {
 public:
  TreeStage(const StageContext& context, TreeContext& tree)
      : Stage(context), tree_(tree), kernels_(context.kernels.traversal()) {}
  static constexpr int kSaveBytes = sizeof(HitRecord) + 3 * sizeof(MonoAddress);
  static int load_bytes(const TreeShape& shape);

  bool works_on_slots() const override { return false; }

 protected:
  struct Loads {
    PolyField<MonoAddress> leaf_place;
    PolyField<MonoAddress> treelet_place;
    PolyField<MonoAddress> ray_place;
    PolyField<std::int32_t> treelet;
    PolyPointer<QueuedRay> ray;
    PolyPointer<TriangleRecord> leaf;
    int treelet_offset;
  };
  Loads loads(std::uint64_t step) const;

  /// Of a block of the ray bin, packed: PEs with a ray.
  LaneMask packed_rays(int block) const;
  /// The next block.
  void load_packed_rays(std::uint64_t step, int block);

  /// What rays want of the tree.
  struct Needs {
    LaneMask leaf;
    LaneMask treelet;
    int leaves = 0;
  };
  /// Looks it up.
  void locate(std::uint64_t step, PolyPointer<TraversalRecord> record, const LaneMask& rays, Needs& needs);
  void load_leaves(std::uint64_t step, Needs& needs);
  void load_treelets(std::uint64_t step, const Needs& needs);
  /// All of this.
  void load_tree(std::uint64_t step, PolyPointer<TraversalRecord> record, const LaneMask& rays, Needs& needs);
  /// Puts rays that were loaded where rays in the tree are kept.
  void enter(std::uint64_t step, PolyPointer<TraversalRecord> record, const LaneMask& rays);
  /// Returns those that go on.
  LaneMask traverse(std::uint64_t step, PolyPointer<TraversalRecord> record, const LaneMask& rays,
                    const Needs& needs);
  /// Makes the hits of rays that are through, and saves them.
  void finish(std::uint64_t step, PolyPointer<TraversalRecord> record, const LaneMask& rays);
  void save_hits(std::uint64_t step);
  void count_pass(std::size_t pass, const LaneMask& rays);
  void count_rays(std::size_t pass, std::uint64_t rays) {
    if (context_.counts.traversal.rays.size() <= pass) make_room_for_counts(pass);
    context_.counts.traversal.rays[pass] += rays;
  }
  /// Of a pass that has rays, which may be fewer than these.
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

/// Between the tree and the intersection bin: brings each slot what became of its ray.
class RecallStage : public Stage {
 public:
  RecallStage(const StageContext& context, const TreeContext& tree) : Stage(context), tree_(tree) {}

  const char* bin() const override { return "intersection bin"; }
  void load(std::uint64_t step, int block) override;
  void process(std::uint64_t step, int block) override;
  void save(std::uint64_t, int) override {}

 private:
  const TreeContext& tree_;
};

/// Takes all rays of the ray bin through the tree.
class TreeTraversal {
 public:
  using Plan = std::function<void(Stage&, int block)>;

  TreeTraversal(const StageContext& context, TreeContext& tree) : tree_(tree), recall_(context, tree) {}
  virtual ~TreeTraversal() = default;
  TreeTraversal(const TreeTraversal&) = delete;
  TreeTraversal& operator=(const TreeTraversal&) = delete;

  /// Plans the first steps for the rays that are in the ray bin.
  void begin_pass(const Plan& plan);
  /// Plans those that follow from one that was processed.
  virtual void after_step(const Stage& stage, int block, const Plan& plan) = 0;
  virtual bool has(const Stage& stage) const = 0;

  RecallStage& recall() { return recall_; }

 protected:
  virtual void plan_first(const Plan& plan) = 0;

 private:
  TreeContext& tree_;
  RecallStage recall_;
};

}  // namespace path_tracer
