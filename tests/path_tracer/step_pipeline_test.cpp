// The pipeline alone, with stages that only note what is asked of them.

#include "firmware/path_tracer/pipeline/step_pipeline.hpp"

#include <gtest/gtest.h>

#include <utility>

#include "tests/support/late_machine.hpp"

namespace step_pipeline_test {

using path_tracer::Stage;
using path_tracer::StageContext;
using path_tracer::StepPipeline;
using path_tracer::TransferRing;
using Calls = std::vector<std::string>;

/// Notes calls as "load a 0": what, its name, the block.
class NotingStage : public Stage {
 public:
  NotingStage(const StageContext& context, const char* name, Calls& calls)
      : Stage(context), name_(name), calls_(calls) {}

  const char* name() const override { return name_; }
  bool works_on_slots() const override { return on_slots; }
  bool prepares() const override { return has_second_load; }
  void load(std::uint64_t, int block) override { note("load", block); }
  void prepare(std::uint64_t, int block) override { note("prepare", block); }
  void process(std::uint64_t, int block) override { note("process", block); }
  void save(std::uint64_t, int block) override { note("save", block); }

  bool on_slots = true;
  bool has_second_load = false;

 private:
  void note(const char* what, int block) {
    calls_.push_back(std::string(what) + " " + name_ + " " + std::to_string(block));
  }

  const char* name_;
  Calls& calls_;
};

class StepPipelineTest : public testing::Test {
 protected:
  static constexpr int kSteps = 2;  ///< loaded at a time

  Calls take_calls() { return std::exchange(calls, {}); }

  Calls calls;
  test_support::LateMachine machine{8, 1024, 4096};
  TransferRing loads{machine, "load", {kSteps, 16, false}};
  TransferRing saves{machine, "save", {kSteps, 16, false}};
  path_tracer::Kernels kernels{};
  path_tracer::ProgramConfig config;
  path_tracer::Layout layout;
  path_tracer::Bins bins;
  path_tracer::RunCounts counts;
  StageContext context{machine, kernels, config, layout, loads, saves, bins, counts};
  NotingStage a{context, "a", calls};
  NotingStage b{context, "b", calls};
  StepPipeline steps{machine, {loads, saves, kSteps}};
};

TEST_F(StepPipelineTest, LoadsAsManyStepsAsItHasBuffersAndRunsThemInOrder) {
  for (int block = 0; block < 3; ++block) steps.plan(a, block);
  steps.load_ahead();
  EXPECT_EQ(take_calls(), (Calls{"load a 0", "load a 1"}));
  EXPECT_TRUE(steps.has_planned());
  EXPECT_EQ(steps.next()->block, 0);
  steps.run_next();
  steps.load_ahead();
  EXPECT_EQ(take_calls(), (Calls{"process a 0", "save a 0", "load a 2"}));
  EXPECT_FALSE(steps.has_planned());
  steps.run_next();
  steps.run_next();
  EXPECT_EQ(take_calls(), (Calls{"process a 1", "save a 1", "process a 2", "save a 2"}));
  EXPECT_EQ(steps.next(), nullptr);
  EXPECT_EQ(steps.steps(), 3u);
}

TEST_F(StepPipelineTest, LoadsAcrossTheBorderBetweenStages) {
  steps.plan(a, 0), steps.plan(a, 1), steps.plan(b, 0);
  steps.load_ahead();
  steps.run_next();
  steps.load_ahead();
  EXPECT_EQ(take_calls(), (Calls{"load a 0", "load a 1", "process a 0", "save a 0", "load b 0"}));
}

/// The records come from the earlier step.
TEST_F(StepPipelineTest, HoldsBackALoadOfABlockThatIsStillToBeProcessed) {
  steps.plan(a, 0), steps.plan(b, 0);
  steps.load_ahead();
  EXPECT_EQ(take_calls(), Calls{"load a 0"});
  steps.run_next();
  steps.load_ahead();
  EXPECT_EQ(take_calls(), (Calls{"process a 0", "save a 0", "load b 0"}));
}

TEST_F(StepPipelineTest, BlocksOfAStagesOwnAreNoBlocksOfSlots) {
  b.on_slots = false;
  steps.plan(a, 0), steps.plan(b, 0), steps.plan(b, 0);
  steps.load_ahead();
  EXPECT_EQ(take_calls(), (Calls{"load a 0", "load b 0"}));
  steps.run_next();
  steps.load_ahead();
  EXPECT_EQ(take_calls(), (Calls{"process a 0", "save a 0"})) << "b's own block 0 is still to be processed";
}

/// Three steps are loaded instead of two; the last of them waits for its turn to be prepared.
TEST_F(StepPipelineTest, SecondLoadsBeginAheadToo) {
  a.has_second_load = true;
  for (int block = 0; block < 4; ++block) steps.plan(a, block);
  steps.load_ahead();
  EXPECT_EQ(take_calls(), (Calls{"load a 0", "load a 1", "load a 2", "prepare a 0"}));
  steps.load_ahead();
  EXPECT_EQ(take_calls(), Calls{"prepare a 1"}) << "its loads are not new any more";
  steps.run_next();
  steps.load_ahead();
  EXPECT_EQ(take_calls(), (Calls{"process a 0", "save a 0", "load a 3", "prepare a 2"}));
}

TEST_F(StepPipelineTest, StepsWithoutLoadsRunAtOnceAndTakeANumber) {
  std::vector<std::uint64_t> numbers;
  for (int block = 0; block < 3; ++block)
    steps.run_without_loads(a, block, [&](std::uint64_t step) { numbers.push_back(step); });
  EXPECT_EQ(numbers, (std::vector<std::uint64_t>{0, 1, 2}));
  EXPECT_EQ(take_calls(), (Calls{"save a 0", "save a 1", "save a 2"}));
  EXPECT_EQ(steps.steps(), 3u);
}

/// A buffer is free when the transfers of the step that had it before are over.
TEST_F(StepPipelineTest, WaitsForItsBuffersBeforeAStep) {
  const auto transfer = [&](TransferRing& ring, std::uint64_t step) {
    ring.copy_p2m(step, 0, cn::MonoPlaces::array(0, 16), ring.buffer(step), cn::LaneMask::first(8));
  };
  steps.plan(a, 0);
  steps.load_ahead();
  transfer(loads, 0);
  transfer(saves, 0);
  machine.calls.clear();
  steps.run_next();
  EXPECT_EQ(machine.calls, (Calls{"wait load 0", "wait save 0"}));
  transfer(saves, 0);
  steps.wait_for_saves();
  EXPECT_EQ(machine.under_way(), 0u);
}

}  // namespace step_pipeline_test
