// A replayed run equals the full run in every statistic, for every parameter that is declared to change
// timing only.

#include "testbench/sweep/replay.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "model/config/chip_parameters.hpp"
#include "model/config/chip_presets.hpp"
#include "testbench/statistics/render_report.hpp"
#include "testbench/sweep/point_work.hpp"
#include "testbench/system/error.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/systemc_fixture.hpp"

namespace replay_test {

using path_tracer::Program;
using test_support::render_options;
using test_support::small_cornell_box;
using testbench::Recording;
using testbench::RenderOptions;
using testbench::RenderResult;
using testbench::Scene;

class Replay : public test_support::SystemCFixture {
 protected:
  /// The statistics without the simulator's times.
  static std::string statistics(const RenderOptions& options, const RenderResult& result) {
    nlohmann::ordered_json json = testbench::render_statistics({"scene", options, false}, result);
    json.erase("simulator");
    return json.dump(1);
  }
  static std::string in_full(const Scene& scene, const RenderOptions& options) {
    new_context();
    return statistics(options, testbench::render_on_chip(scene, options));
  }
  static std::string replayed(const Recording& recording, const RenderOptions& options) {
    new_context();
    return statistics(options, testbench::replay_on_chip(recording, options));
  }
};

TEST_F(Replay, EqualsTheFullRunForEveryProgramAndBuffering) {
  const Scene scene = small_cornell_box({12, 10});
  for (const Program program : {Program::segments, Program::direct, Program::full}) {
    for (const int n : {0, 1, 3}) {
      for (const bool saves : {false, true}) {
        RenderOptions options = render_options(program, 2);
        options.program.n = n;
        options.program.buffer_saves = saves;
        SCOPED_TRACE("program " + std::to_string(int(program)) + ", n " + std::to_string(n));
        const Recording recording = testbench::record_render(scene, options);
        EXPECT_EQ(replayed(recording, options), in_full(scene, options));
      }
    }
  }
}

TEST_F(Replay, EqualsTheFullRunApproximatelyTimed) {
  const Scene scene = small_cornell_box({8, 8});
  RenderOptions options = render_options(Program::full, 2);
  options.timing = model::TimingStyle::approximately_timed;
  const Recording recording = testbench::record_render(scene, options);
  EXPECT_EQ(replayed(recording, options), in_full(scene, options));
}

TEST_F(Replay, EqualsTheFullRunWherePathsAreFlushed) {
  const Scene scene = test_support::closed_cube(0.9, 0.1, {8, 8});
  RenderOptions options = render_options(Program::full, 2);
  options.program.slot_vertices = 4;
  options.chip.chip.pes = 32;
  const Recording recording = testbench::record_render(scene, options);
  ASSERT_GT(recording.result.counts.folds, 0u);
  EXPECT_EQ(replayed(recording, options), in_full(scene, options));
}

/// A value other than the default, as far from it as a run allows.
model::ParameterValue other_value(const model::ParameterInfo& parameter) {
  if (parameter.key == "chip.clock_hz") return 500e6;
  if (parameter.key == "ddr.size_bytes") return std::int64_t{64} << 20;
  if (parameter.key == "ddr.refresh_cycles") return std::int64_t{700};
  if (parameter.key == "ddr.page_hit_cycles") return std::int64_t{7};
  if (parameter.key == "ddr.banks") return std::int64_t{2};
  if (parameter.key == "ddr.refresh_interval_cycles") return std::int64_t{97};
  if (parameter.key == "ddr.page_miss_cycles") return std::int64_t{137};
  if (parameter.key == "ddr.page_bytes") return std::int64_t{2048};
  if (parameter.key == "clear_connect.bytes_per_cycle") return std::int64_t{3};
  if (parameter.key == "clear_connect.packet_bytes") return std::int64_t{128};
  if (parameter.key == "chip.watchdog_cycles") return std::int64_t{1'000'000'000};  // fewer end the run
  if (parameter.key == "control.cache_line_bytes") return std::int64_t{64};
  if (parameter.key == "control.data_cache_bytes") return std::int64_t{256};
  if (const auto* const range = std::get_if<model::IntegerRange>(&parameter.allowed)) {
    const std::int64_t value = std::get<std::int64_t>(parameter.default_value);
    const std::int64_t other = value > range->low + 2 ? range->low + 2 : 5 * value + 2;
    return std::min(range->high, other / range->multiple_of * range->multiple_of);
  }
  if (const auto* const range = std::get_if<model::RealRange>(&parameter.allowed)) {
    const double value = std::get<double>(parameter.default_value);
    return 3.7 * value + 1.3 <= range->high ? 3.7 * value + 1.3 : (range->low + value) / 2;
  }
  if (const auto* const flag = std::get_if<bool>(&parameter.default_value)) return !*flag;
  const auto& names = std::get<model::Choice>(parameter.allowed);
  return std::string(names[0] == std::get<std::string>(parameter.default_value) ? names[1] : names[0]);
}

/// Checks the declaration `Effect::timing` parameter by parameter: the chip with another value makes the same
/// image, and all of its statistics equal those of a replay of the default chip's recording.
TEST_F(Replay, EveryParameterDeclaredTimingOnlyLeavesImageAndStreamAlone) {
  const Scene scene = small_cornell_box({8, 6});
  const RenderOptions options = render_options(Program::full, 2);
  const Recording recording = testbench::record_render(scene, options);
  int parameters = 0;
  for (const model::ParameterInfo& parameter : model::parameter_table()) {
    if (parameter.effect != model::Effect::timing) continue;
    SCOPED_TRACE(parameter.key);
    RenderOptions changed = options;
    const model::ParameterValue other = other_value(parameter);
    ASSERT_NE(other, parameter.read(options.chip));
    model::set_parameter_value(changed.chip, parameter.key, other, "test");
    model::validate(changed.chip);
    const Recording again = testbench::record_render(scene, changed);
    EXPECT_TRUE(again.stream == recording.stream);
    EXPECT_EQ(again.result.film.sha256(), recording.result.film.sha256());
    EXPECT_EQ(replayed(recording, changed), in_full(scene, changed));
    ++parameters;
  }
  EXPECT_GT(parameters, 60);
}

TEST_F(Replay, WhatTheFirmwareSeesChangesTheStream) {
  const Scene scene = small_cornell_box({8, 6});
  const RenderOptions options = render_options(Program::full, 2);
  RenderOptions wider = options;
  wider.chip.chip.pes = 32;
  EXPECT_FALSE(testbench::record_render(scene, wider).stream ==
               testbench::record_render(scene, options).stream);
  EXPECT_EQ(model::find_parameter("chip.pes")->effect, model::Effect::stream);
  EXPECT_EQ(model::find_parameter("poly.sram_bytes")->effect, model::Effect::stream);
}

TEST_F(Replay, OfAnotherWidthIsRefused) {
  const Scene scene = small_cornell_box({8, 6});
  RenderOptions options = render_options(Program::direct, 1);
  const Recording recording = testbench::record_render(scene, options);
  options.chip.chip.pes = 64;
  EXPECT_THROW(replayed(recording, options), testbench::RunError);
}

/// Shows that an audit can find a difference.
TEST_F(Replay, AnAuditFindsTheRecordingOfAnotherRun) {
  const Scene scene = small_cornell_box({8, 6});
  const auto point_with = [&](const RenderOptions& options) {
    testbench::SweepPoint made;
    made.run = testbench::RenderPoint{{"scene", options, false}, &scene};
    return made;
  };
  RenderOptions other = render_options(Program::full, 1);
  other.program.n = 2;
  const testbench::SweepPoint point = point_with(render_options(Program::full, 1));
  const testbench::PointRecording own = testbench::record_point(point);
  const testbench::PointRecording of_another = testbench::record_point(point_with(other));
  const auto audit = [&](const testbench::PointRecording& recording) {
    return testbench::run_point(point, &recording, testbench::PointMode::audit);
  };
  EXPECT_NE(audit(own).find("\"audited\":true"), std::string::npos);
  try {
    audit(of_another);
    ADD_FAILURE() << "no difference found";
  } catch (const testbench::RunError& error) {
    EXPECT_NE(std::string(error.what()).find("audit: replayed and full run differ: /"), std::string::npos)
        << error.what();
  }
}

}  // namespace replay_test
