// Long renders told from short parts of them: how far off, and how often the interval holds the truth.

#include "testbench/estimate/estimate.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "firmware/path_tracer/program/program_options.hpp"
#include "model/config/chip_presets.hpp"
#include "testbench/scene_file/scene_file.hpp"
#include "testbench/system/processes.hpp"

namespace estimate_test {

using testbench::Estimate;
using testbench::estimate_render;
using testbench::RenderRequest;
using testbench::Scene;

/// 64 slots: 8 samples of 8 x 8 pixels are a batch.
RenderRequest small_request(int samples, std::uint64_t seed) {
  RenderRequest request{"cornell_box", {}, false};
  request.options.chip = model::preset("csx600");
  request.options.chip.chip.pes = 16;
  request.options.program = path_tracer::default_program();
  request.options.program.bin_blocks = 4;
  request.options.program.seed = seed;
  request.options.work.samples = samples;
  request.options.film_sums = testbench::FilmSums::means;
  return request;
}

Scene small_box() {
  Scene scene = testbench::load_scene(CSX600_SCENES_DIR "/cornell_box");
  scene.film = {8, 8};
  return scene;
}

/// A run on the chip needs a process of its own.
double full_run(const Scene& scene, const RenderRequest& request, const std::string& key) {
  const auto run = [&] { return std::to_string(render_in_full(scene, request).counter(key).value); };
  return std::stod(testbench::run_in_processes({run}, 1)[0]);
}

TEST(EstimateOfARender, IntervalsHoldTheTruthAsOftenAsTheySay) {
  const Scene scene = small_box();
  int held = 0;
  double sum_of_errors = 0;
  constexpr int kJobs = 20;
  for (std::uint64_t seed = 1; seed <= kJobs; ++seed) {
    const RenderRequest request = small_request(2000, seed);
    const Estimate estimate = estimate_render(scene, request, {0.03, 2}, [](int) {});
    ASSERT_GT(estimate.batches, 0);
    EXPECT_LE(estimate.relative_half_width(), 0.03);
    EXPECT_LE(2 * estimate.samples_rendered, 2000);
    const double truth = full_run(scene, request, "simulated_cycles");
    const testbench::EstimatedCounter& cycles = estimate.counter("simulated_cycles");
    held += std::abs(cycles.value - truth) <= cycles.half_width ? 1 : 0;
    sum_of_errors += cycles.value / truth - 1;
  }
  EXPECT_GE(held, 18);
  EXPECT_LT(std::abs(sum_of_errors / kJobs), 0.005);
}

TEST(EstimateOfARender, CountersThatThePathsDecideAddUp) {
  const Scene scene = small_box();
  const RenderRequest request = small_request(2000, 7);
  const Estimate estimate = estimate_render(scene, request, {0.03, 2}, [](int) {});
  // Paths are as many as were asked for, without any doubt.
  EXPECT_NEAR(estimate.counter("counts.paths").value, 2000 * 64, 1e-6);
  EXPECT_NEAR(estimate.counter("counts.paths").half_width, 0, 1e-6);
  EXPECT_NEAR(estimate.counter("chip.pes").value, 16, 1e-9);
  for (const char* const key : {"segments", "chip.energy.joules", "chip.ddr.bytes_read"}) {
    const double truth = full_run(scene, request, key);
    EXPECT_NEAR(estimate.counter(key).value / truth, 1, 0.03) << key;
  }
}

TEST(EstimateOfARender, ANarrowerIntervalTakesMoreSamples) {
  const Scene scene = small_box();
  const RenderRequest request = small_request(40000, 3);
  const Estimate wide = estimate_render(scene, request, {0.03, 2}, [](int) {});
  const Estimate narrow = estimate_render(scene, request, {0.008, 2}, [](int) {});
  EXPECT_LT(wide.samples_rendered, narrow.samples_rendered);
  EXPECT_LE(narrow.relative_half_width(), 0.008);
}

TEST(EstimateOfARender, AShortRenderIsRunInFull) {
  const Scene scene = small_box();
  const RenderRequest request = small_request(20, 1);
  const auto run = [&] {
    const Estimate estimate = estimate_render(scene, request, {0.005, 1}, [](int) {});
    return std::to_string(estimate.batches) + " " + std::to_string(estimate.counter("segments").half_width);
  };
  EXPECT_EQ(testbench::run_in_processes({run}, 1)[0], "0 0.000000");
}

}  // namespace estimate_test
