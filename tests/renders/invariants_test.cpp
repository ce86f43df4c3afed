// What docs/design.md, section 7, promises of every run, on small images: equal bits, equal cycles, equal
// statistics.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "firmware/path_tracer/path_tracer.hpp"
#include "testbench/run/host_pc.hpp"
#include "testbench/run/render.hpp"
#include "testbench/statistics/render_report.hpp"
#include "testbench/system/error.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/systemc_fixture.hpp"
#include "tests/support/temporary_directory.hpp"

namespace invariants_test {

using cn::Level;
using path_tracer::Program;
using test_support::FilmSize;
using test_support::render_options;
using test_support::small_cornell_box;
using testbench::RenderOptions;
using testbench::RenderResult;
using testbench::Scene;

class Invariants : public test_support::SystemCFixture {
 protected:
  /// Renders on a new chip.
  static RenderResult on_chip(const Scene& scene, const RenderOptions& options) {
    new_context();
    return testbench::render_on_chip(scene, options);
  }
};

/// The statistics without the simulator's times.
std::string statistics(const RenderOptions& options, const RenderResult& result) {
  nlohmann::ordered_json json = testbench::render_statistics({"scene", options, false}, result);
  json.erase("simulator");
  return json.dump(1);
}

struct Variation {
  std::string name;
  std::function<void(RenderOptions&)> apply;
};

std::vector<Variation> firmware_variations() {
  std::vector<Variation> variations;
  for (const int n : {0, 1, 2, 3, 8}) {
    for (const bool loads : {false, true}) {
      for (const bool saves : {false, true}) {
        variations.push_back({"n " + std::to_string(n) + (loads ? ", loads" : "") + (saves ? ", saves" : ""),
                              [=](RenderOptions& options) {
                                options.program.n = n;
                                options.program.buffer_loads = loads;
                                options.program.buffer_saves = saves;
                              }});
      }
    }
  }
  for (const int blocks : {1, 2, 3, 7, 40})
    variations.push_back({std::to_string(blocks) + " blocks",
                          [=](RenderOptions& options) { options.program.bin_blocks = blocks; }});
  for (const int vertices : {4, 8, 64})
    variations.push_back({std::to_string(vertices) + " vertices a slot",
                          [=](RenderOptions& options) { options.program.slot_vertices = vertices; }});
  variations.push_back({"shadow rays whichever way",
                        [](RenderOptions& options) { options.program.cull_shadow_rays = false; }});
  variations.push_back({"one block of n 1 and short slots", [](RenderOptions& options) {
                          options.program.bin_blocks = 1;
                          options.program.slot_vertices = 4;
                        }});
  return variations;
}

std::vector<Variation> chip_variations() {
  std::vector<Variation> variations;
  for (const int pes : {16, 32, 96, 128, 256})
    variations.push_back(
        {std::to_string(pes) + " PEs", [=](RenderOptions& options) { options.chip.chip.pes = pes; }});
  for (const Level level : cn::usable_levels())
    variations.push_back(
        {"level " + cn::name_of(level), [=](RenderOptions& options) { options.level = level; }});
  for (const auto arbitration :
       {model::PioArbitration::strict_fifo, model::PioArbitration::reads_overtake_writes,
        model::PioArbitration::queue_per_direction}) {
    variations.push_back({"arbitration " + std::to_string(int(arbitration)), [=](RenderOptions& options) {
                            options.chip.pio.arbitration = arbitration;
                            options.program.n = 3;
                          }});
  }
  variations.push_back(
      {"consolidation", [](RenderOptions& options) { options.chip.pio.consolidate_equal_addresses = true; }});
  variations.push_back({"slow PIO, short queue", [](RenderOptions& options) {
                          options.chip.pio.setup_cycles = 5000;
                          options.chip.pio.queue_depth = 1;
                        }});
  variations.push_back({"slow memory and host", [](RenderOptions& options) {
                          options.chip.ddr.page_miss_cycles = 400;
                          options.chip.ddr.banks = 1;
                          options.chip.host.latency_cycles = 1000000;
                        }});
  variations.push_back({"fast clock", [](RenderOptions& options) { options.chip.chip.clock_hz = 1.7e9; }});
  return variations;
}

std::vector<Variation> all_variations() {
  std::vector<Variation> variations = firmware_variations();
  for (Variation& variation : chip_variations()) variations.push_back(std::move(variation));
  return variations;
}

/// The length of the slots decides how the recursion of a long path is rounded, so each length has its own
/// film.
class ExpectedFilms {
 public:
  ExpectedFilms(const Scene& scene, const RenderOptions& options) : scene_(scene), options_(options) {}

  const std::string& with_slots_of(int vertices) {
    std::string& sha256 = sha256_[vertices];
    if (sha256.empty()) {
      options_.program.slot_vertices = vertices;
      sha256 = testbench::render_natively(scene_, options_).film.sha256();
    }
    return sha256;
  }

 private:
  const Scene& scene_;
  RenderOptions options_;
  std::map<int, std::string> sha256_;
};

TEST_F(Invariants, EveryWayToRunGivesTheSameBits) {
  for (const auto& [film, samples] :
       {std::pair{FilmSize{1, 1}, 7}, {FilmSize{3, 2}, 5}, {FilmSize{17, 5}, 24}}) {
    const Scene scene = small_cornell_box(film);
    for (const auto& [program, best] :
         {std::pair{Program::segments, false}, {Program::full, false}, {Program::full, true}}) {
      RenderOptions base = render_options(program, samples);
      if (best) {
        base.program.sampler = path_tracer::Sampler::sobol;
        base.program.light_sampling = path_tracer::LightSampling::solid_angle;
      }
      ExpectedFilms expected_films(scene, base);
      for (const Variation& variation : all_variations()) {
        RenderOptions options = base;
        variation.apply(options);
        if (options.program.n > options.program.bin_blocks) continue;
        const std::string& expected = expected_films.with_slots_of(options.program.slot_vertices);
        const std::string name =
            variation.name + ", " + std::to_string(film.width) + " x " + std::to_string(film.height);
        EXPECT_EQ(testbench::render_natively(scene, options).film.sha256(), expected) << name << ", native";
        EXPECT_EQ(on_chip(scene, options).film.sha256(), expected) << name;
        if (program != Program::full) continue;
        options.program.program = Program::direct;
        EXPECT_EQ(on_chip(scene, options).film.sha256(), expected) << name << ", direct";
      }
    }
  }
}

TEST_F(Invariants, SamplesAreTracedOnceEach) {
  const Scene scene = small_cornell_box({17, 5});
  for (const Variation& variation : all_variations()) {
    RenderOptions options = render_options(Program::full, 24);
    variation.apply(options);
    if (options.program.n > options.program.bin_blocks) continue;
    const RenderResult result = on_chip(scene, options);
    EXPECT_EQ(result.counts.paths, 17u * 5u * 24u) << variation.name;
    for (int pixel = 0; pixel < result.film.pixel_count(); ++pixel)
      ASSERT_EQ(result.film.sample_count(pixel), 24u) << variation.name << ", pixel " << pixel;
  }
}

TEST_F(Invariants, EveryCycleHasOneCause) {
  const Scene scene = small_cornell_box({17, 5});
  for (const Variation& variation : all_variations()) {
    for (const Program program : {Program::segments, Program::direct, Program::full}) {
      RenderOptions options = render_options(program, 24);
      variation.apply(options);
      if (options.program.n > options.program.bin_blocks) continue;
      const testbench::ChipStatistics chip = *on_chip(scene, options).chip;
      EXPECT_EQ(chip.control.total(), chip.firmware_cycles) << variation.name;
      EXPECT_EQ(chip.control[model::CycleCause::poly], chip.all_kernels.cycles) << variation.name;
      EXPECT_EQ(chip.control[model::CycleCause::wait_pio_queue], chip.pio.blocked_cycles) << variation.name;
      EXPECT_EQ(chip.pio.late_starts, 0u) << variation.name;
      EXPECT_GE(chip.total_cycles, chip.firmware_cycles) << variation.name;
    }
  }
}

TEST_F(Invariants, BufferingDoesNotChangeTheWork) {
  const Scene scene = small_cornell_box({17, 5});
  const path_tracer::RunCounts expected = on_chip(scene, render_options(Program::full, 24)).counts;
  for (const int n : {0, 2, 8}) {
    RenderOptions options = render_options(Program::full, 24);
    options.program.n = n;
    const path_tracer::RunCounts counts = on_chip(scene, options).counts;
    EXPECT_EQ(counts.segments, expected.segments);
    EXPECT_EQ(counts.shadow_rays, expected.shadow_rays);
    EXPECT_EQ(counts.blocks, expected.blocks);
    EXPECT_EQ(counts.skipped_blocks, expected.skipped_blocks);
    EXPECT_EQ(counts.steps, expected.steps);
  }
}

TEST_F(Invariants, StatisticsRepeatByteForByte) {
  const Scene scene = small_cornell_box({17, 5});
  for (const Program program : {Program::segments, Program::direct, Program::full}) {
    RenderOptions options = render_options(program, 24);
    const std::string first = statistics(options, on_chip(scene, options));
    EXPECT_EQ(statistics(options, on_chip(scene, options)), first);
    for (const Level level : cn::usable_levels()) {
      options.level = level;
      EXPECT_EQ(statistics(options, on_chip(scene, options)), first) << "at level " << cn::name_of(level);
    }
  }
}

TEST_F(Invariants, WavesLogsAndTimelinesChangeNothing) {
  const test_support::TemporaryDirectory directory;
  const Scene scene = small_cornell_box({17, 5});
  for (const Program program : {Program::segments, Program::direct, Program::full}) {
    for (const int n : {0, 1, 3}) {
      for (const int host_latency_cycles : {2100, 1000000}) {
        RenderOptions options = render_options(program, 24);
        options.program.n = n;
        options.chip.host.latency_cycles = host_latency_cycles;
        const RenderResult without_waves = on_chip(scene, options);
        const std::string plain = statistics(options, without_waves);
        RenderOptions with_waves = options;
        testbench::WaveOptions& waves =
            with_waves.observation.waves.emplace(testbench::WaveOptions{directory.path() / "waves.vcd", {}});
        with_waves.observation.transactions = directory.path() / "transactions.jsonl";
        with_waves.observation.timeline = directory.path() / "timeline.json";
        waves.config.selection.level = model::WaveLevel::detail;
        EXPECT_EQ(statistics(options, on_chip(scene, with_waves)), plain) << "n " << n;
        EXPECT_GT(std::filesystem::file_size(waves.file), 10000u);
        waves.config.windows = {
            {without_waves.chip->total_cycles / 2, without_waves.chip->total_cycles / 4 * 3}};
        EXPECT_EQ(statistics(options, on_chip(scene, with_waves)), plain) << "n " << n << ", a window";
      }
    }
  }
}

/// Checks that spans follow each other without gaps, and sums them.
class SpanChecker : public model::ControlObserver {
 public:
  void spent(model::CycleCause cause, model::Cycles start, model::Cycles finish, int semaphore) override {
    if (spans_ > 0) {
      EXPECT_EQ(start, last_finish_);
    }
    EXPECT_LT(start, finish);
    const bool on_semaphore = cause == model::CycleCause::semaphore ||
                              cause == model::CycleCause::wait_load ||
                              cause == model::CycleCause::wait_save || cause == model::CycleCause::wait_host;
    EXPECT_EQ(semaphore >= 0, on_semaphore) << model::cycle_cause_name(cause);
    cycles[std::size_t(cause)] += finish - start;
    last_finish_ = finish;
    ++spans_;
  }
  void ran_kernel(const char*, model::Cycles start, model::Cycles finish, int enabled_pes) override {
    EXPECT_EQ(finish, last_finish_);
    EXPECT_GT(enabled_pes, 0);
    EXPECT_LE(enabled_pes, 96);
    kernel_cycles += finish - start;
  }

  std::array<model::Cycles, model::kCycleCauses> cycles{};
  model::Cycles kernel_cycles = 0;

 private:
  model::Cycles last_finish_ = 0;
  std::uint64_t spans_ = 0;
};

TEST_F(Invariants, AnObserverSeesEveryCycleAndChangesNone) {
  const Scene scene = small_cornell_box({17, 5});
  for (const Program program : {Program::segments, Program::full}) {
    const RenderOptions options = render_options(program, 24);
    const testbench::ChipStatistics expected = *on_chip(scene, options).chip;
    for (const model::Cycles sync_cycles :
         {model::Cycles{1}, model::Cycles{1000}, model::Cycles{100000000}}) {
      new_context();
      const testbench::MonoImage image =
          testbench::make_mono_image(scene, options.chip.chip.pes, options.program);
      testbench::Film film(scene.film, testbench::film_scale(scene));
      model::Csx600 chip("chip", options.chip);
      testbench::HostPc host("host", chip, image, film);
      SpanChecker checker;
      chip.control_unit.set_observer(&checker, sync_cycles);
      chip.control_unit.load([&](cn::Machine& machine) {
        path_tracer::PathTracer(machine, path_tracer::kernels(options.level), options.program, image.layout,
                                options.work)
            .run({});
      });
      sc_core::sc_start();
      chip.control_unit.rethrow_failure();
      EXPECT_EQ(testbench::to_json(testbench::collect_statistics(chip, host.finished_cycle())).dump(),
                testbench::to_json(expected).dump());
      EXPECT_EQ(checker.cycles, expected.control.cycles);
      EXPECT_EQ(checker.kernel_cycles,
                expected.control[model::CycleCause::poly] + expected.control[model::CycleCause::stolen]);
    }
  }
}

TEST_F(Invariants, FilmsHoldNothingButRadiance) {
  for (const Scene& scene : {small_cornell_box({17, 5}), test_support::triangle_soup(40, 3, {17, 5}),
                             test_support::closed_cube(0.95, 1.0, {17, 5})}) {
    for (const Program program : {Program::segments, Program::full}) {
      const RenderResult result = on_chip(scene, render_options(program, 48));
      EXPECT_EQ(result.film.rejected_samples(), 0u);
      double sum = 0;
      for (const double value : result.film.rgb()) {
        EXPECT_TRUE(std::isfinite(value) && value >= 0) << value;
        sum += value;
      }
      EXPECT_GT(sum, 0.0) << scene.name;
    }
  }
}

TEST(RejectedSamples, StopTheRunByName) {
  testbench::Film film({2, 1}, 1.0);
  EXPECT_NO_THROW(testbench::require_no_rejected_samples(film));
  film.add(0, {std::nan(""), 0, 0});
  film.add(1, {-1, 0, 0});
  film.add(1, {0, -1, 0});
  film.add(1, {0, 1e300, 0});
  try {
    testbench::require_no_rejected_samples(film);
    FAIL() << "no error";
  } catch (const testbench::RunError& error) {
    const std::string message = error.what();
    for (const char* part : {"4 samples", "1 not finite", "2 negative", "1 above"})
      EXPECT_NE(message.find(part), std::string::npos) << message;
  }
}

}  // namespace invariants_test
