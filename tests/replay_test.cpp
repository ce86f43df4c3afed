// A replayed run equals the full one in every statistic, for every parameter that is said to change timing
// only.

#include "testbench/sweep/replay.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <nlohmann/json.hpp>

#include "model/chip_parameters.hpp"
#include "model/chip_presets.hpp"
#include "testbench/error.hpp"
#include "testbench/render_report.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/systemc_fixture.hpp"

namespace {

using path_tracer::Program;
using test_support::render_options;
using test_support::small_cornell_box;
using testbench::Recording;
using testbench::RenderOptions;
using testbench::RenderResult;
using testbench::Scene;

class Replay : public test_support::SystemCFixture {
 protected:
  static void new_context() {
    sc_core::sc_curr_simcontext = new sc_core::sc_simcontext();
    sc_core::sc_default_global_context = sc_core::sc_curr_simcontext;
  }
  /// Everything but the host's times.
  static std::string statistics(const RenderOptions& options, const RenderResult& result) {
    nlohmann::ordered_json json = testbench::render_statistics({"scene", options, false}, result);
    json.erase("host");
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

}  // namespace
