// Renders in passes: the bits of one run, adaptive pictures that depend on nothing but their samples, time
// budgets.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "testbench/passes/pass_render.hpp"
#include "testbench/sampling/adaptive_plan.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/statistics.hpp"
#include "tests/support/systemc_fixture.hpp"

namespace pass_render_test {

using path_tracer::Program;
using test_support::FilmSize;
using test_support::render_options;
using testbench::AdaptivePlan;
using testbench::BudgetClock;
using testbench::PassEnd;
using testbench::PassRender;
using testbench::RenderRequest;
using testbench::SamplePlan;
using testbench::Scene;
using testbench::ShapedPlan;
using testbench::TimeBudget;

class PassRenders : public test_support::SystemCFixture {
 protected:
  PassRender render(const Scene& scene, const RenderRequest& request, SamplePlan&& plan,
                    const std::optional<TimeBudget>& budget = {}) {
    return *testbench::render_in_passes(ranks_, scene, request, plan, budget, {});
  }

 private:
  testbench::Ranks ranks_;
};

std::vector<double> even_importance(FilmSize film) {
  return std::vector<double>(std::size_t(film.width) * std::size_t(film.height), 1.0);
}

RenderRequest request_of(Program program, bool native) {
  return {"scene", render_options(program, 1), native};
}

constexpr FilmSize kFilm{24, 20};

TEST_F(PassRenders, OfOneShapeMakeThePictureOfOneRun) {
  const Scene scene = test_support::small_cornell_box(kFilm);
  const std::string expected =
      testbench::render_natively(scene, render_options(Program::full, 11)).film.sha256();
  for (const bool native : {true, false}) {
    const PassRender found =
        render(scene, request_of(Program::full, native), ShapedPlan(even_importance(kFilm), 11));
    EXPECT_EQ(found.film.sha256(), expected);
    EXPECT_EQ(found.passes, 5) << "1, 2, 4, 8, 11 samples";
    EXPECT_EQ(found.end, PassEnd::plan_complete);
    EXPECT_EQ(found.simulated_seconds.has_value(), !native);
    EXPECT_EQ(found.statistics["parts"].size(), 5u);
    EXPECT_EQ(found.statistics["image_sha256"], expected);
  }
}

TEST_F(PassRenders, OfAdaptiveSamplingDependOnTheSamplesOnly) {
  const Scene scene = test_support::small_cornell_box(kFilm);
  const auto adaptive = [] { return AdaptivePlan(even_importance(kFilm), 256, 0.12); };
  RenderRequest request = request_of(Program::full, true);
  const PassRender expected = render(scene, request, adaptive());
  const testbench::PixelSamples samples = expected.film.samples();
  EXPECT_LT(samples.fewest, samples.most);
  EXPECT_GE(samples.fewest, std::uint64_t(AdaptivePlan::kFirstSamples));
  request.options.program.n = 3;
  request.options.program.bin_blocks = 5;
  EXPECT_EQ(render(scene, request, adaptive()).film.sha256(), expected.film.sha256());
  request.options.chip.chip.pes = 32;
  EXPECT_EQ(render(scene, request, adaptive()).film.sha256(), expected.film.sha256());
  request.native = false;
  const PassRender on_chip = render(scene, request, adaptive());
  EXPECT_EQ(on_chip.film.sha256(), expected.film.sha256());
  double seconds = 0;
  for (const auto& part : on_chip.statistics["parts"]) seconds += part["simulated_seconds"].get<double>();
  EXPECT_EQ(*on_chip.simulated_seconds, seconds);
}

/// In a closed enclosure of albedo 1/2 and emission 1/2 the radiance is 1 everywhere, whatever the number of
/// samples that adaptive sampling gives a pixel.
TEST_F(PassRenders, OfAdaptiveSamplingAreUnbiased) {
  constexpr FilmSize kRoom{40, 40};
  const Scene scene = test_support::closed_cube(0.5, 0.5, kRoom);
  double sum = 0;
  double variance = 0;
  double pixels = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    RenderRequest request = request_of(Program::segments, true);
    request.options.program.sampler = path_tracer::Sampler::philox;
    request.options.program.seed = seed;
    const PassRender found = render(scene, request, AdaptivePlan(even_importance(kRoom), 4096, 0.15));
    EXPECT_NE(found.film.samples().fewest, found.film.samples().most) << "nothing was adapted";
    for (int pixel = 0; pixel < found.film.pixel_count(); ++pixel) {
      sum += found.film.mean(pixel).x;
      variance += found.film.variance_of_mean(pixel).x;
      ++pixels;
    }
  }
  const double error = std::sqrt(variance) / pixels;
  EXPECT_NEAR(sum / pixels, 1, test_support::normal_threshold(test_support::kFalseAlarm) * error);
  EXPECT_LT(error, 0.002) << "a bias of a hundredth would show";
}

TEST_F(PassRenders, WithinABudgetOfSimulatedTimeAreNotLate) {
  const Scene scene = test_support::small_cornell_box(kFilm);
  double paths = 0;
  for (const double seconds : {0.03, 0.05, 0.1, 0.2}) {
    const PassRender found =
        render(scene, request_of(Program::full, false), ShapedPlan(even_importance(kFilm), 1 << 16),
               TimeBudget{seconds, BudgetClock::chip});
    EXPECT_EQ(found.end, PassEnd::time_over);
    EXPECT_LE(*found.simulated_seconds, seconds);
    EXPECT_GT(*found.simulated_seconds, 0.5 * seconds) << "time was left for a pass";
    EXPECT_GT(found.film.samples().mean, paths) << "more time, more paths";
    paths = found.film.samples().mean;
  }
}

TEST_F(PassRenders, WithinABudgetThatNoPassFitsMakeOne) {
  const Scene scene = test_support::small_cornell_box(kFilm);
  const PassRender found =
      render(scene, request_of(Program::full, false), ShapedPlan(even_importance(kFilm), 1 << 16),
             TimeBudget{1e-6, BudgetClock::chip});
  EXPECT_EQ(found.passes, 1);
  EXPECT_EQ(found.end, PassEnd::time_over);
  EXPECT_GT(found.film.samples().most, 0u);
}

TEST_F(PassRenders, EndWithTheSamplesWhereTimeIsLeft) {
  const Scene scene = test_support::small_cornell_box(kFilm);
  for (const bool native : {true, false}) {
    const PassRender found =
        render(scene, request_of(Program::full, native), ShapedPlan(even_importance(kFilm), 4),
               TimeBudget{1000, native ? BudgetClock::simulator : BudgetClock::chip});
    EXPECT_EQ(found.end, PassEnd::plan_complete);
    EXPECT_EQ(found.film.sha256(),
              testbench::render_natively(scene, render_options(Program::full, 4)).film.sha256());
  }
}

TEST_F(PassRenders, StopWhenTheyAreInterrupted) {
  const Scene scene = test_support::small_cornell_box(kFilm);
  testbench::Ranks ranks;
  ShapedPlan plan(even_importance(kFilm), 64);
  int passes = 0;
  testbench::PassActions actions;
  actions.after_pass = [&](const testbench::Film&, int) { ++passes; };
  actions.progress = [&](double) { return passes < 2; };
  const PassRender found =
      *testbench::render_in_passes(ranks, scene, request_of(Program::full, true), plan, {}, actions);
  EXPECT_EQ(found.end, PassEnd::interrupted);
  EXPECT_EQ(found.passes, 2);
  EXPECT_EQ(found.statistics["partial"], true);
  EXPECT_EQ(found.film.sha256(),
            testbench::render_natively(scene, render_options(Program::full, 2)).film.sha256())
      << "whole passes only";
}

}  // namespace pass_render_test
