#pragma once

#include <memory>

#include "firmware/path_tracer/pipeline/ray_search.hpp"
#include "firmware/path_tracer/traversals/tree_stage.hpp"

namespace path_tracer {

/// How the rays in the ray queue go through the tree, for each value of `Traversal` that has one.
class TreeTraversal {
 public:
  using Plan = std::function<void(Stage&, int block)>;

  TreeTraversal() = default;
  virtual ~TreeTraversal() = default;
  TreeTraversal(const TreeTraversal&) = delete;
  TreeTraversal& operator=(const TreeTraversal&) = delete;

  /// Plans the first steps for the rays in the ray queue.
  virtual void plan_first(const Plan& plan) = 0;
  /// Plans the steps that follow from one that was processed.
  virtual void after_step(const Stage& stage, int block, const Plan& plan) = 0;
  virtual bool has(const Stage& stage) const = 0;
};

/// Takes rays through the tree. How many steps that takes shows while they run.
class TreeSearch : public RaySearch {
 public:
  explicit TreeSearch(const StageContext& context);

  RayStore& rays() override { return queue_; }
  bool has(const Stage& stage) const override { return traversal_->has(stage); }
  void add_block(StepPipeline& /*steps*/, int /*block*/) override {}
  bool begin_pass(StepPipeline& steps, const std::vector<int>& blocks) override;
  bool after_step(StepPipeline& steps, const Step& step, const std::vector<int>& blocks) override;

 private:
  TreeTraversal::Plan plan_in(StepPipeline& steps);

  RayQueue queue_;
  TreeContext tree_;
  std::unique_ptr<TreeTraversal> traversal_;
  RecallStage recall_;
  int steps_left_ = 0;  ///< planned and not yet processed
};

}  // namespace path_tracer
