// What can be computed from the files that observe a run equals its statistics (docs/design.md, invariant 4),
// loosely and approximately timed.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "testbench/run/render.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/systemc_fixture.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/vcd_reader.hpp"

namespace wave_statistics_test {

using model::CycleCause;
using model::Cycles;
using model::TimingStyle;
using test_support::VcdReader;
using testbench::RenderResult;
using Json = nlohmann::json;

class WaveStatistics : public test_support::SystemCFixture, public testing::WithParamInterface<TimingStyle> {
 protected:
  WaveStatistics() {
    options_ = test_support::render_options(path_tracer::Program::full, 24);
    options_.timing = GetParam();
    options_.observation.waves.emplace(testbench::WaveOptions{path("run.vcd"), {}});
    options_.observation.waves->config.selection.level = model::WaveLevel::detail;
    options_.observation.transactions = path("run.jsonl");
    options_.observation.timeline = path("run.json");
  }

  std::filesystem::path path(const std::string& name) const { return directory_.path() / name; }

  testbench::ChipStatistics run() {
    const RenderResult result = testbench::render_on_chip(test_support::small_cornell_box({17, 5}), options_);
    EXPECT_EQ(result.observation_failures, "");
    return *result.chip;
  }
  VcdReader vcd() const { return VcdReader::of_file(path("run.vcd")); }

  std::uint64_t cycle_at(std::uint64_t picoseconds) const {
    return std::uint64_t(std::llround(double(picoseconds) * options_.chip.chip.clock_hz / 1e12));
  }
  /// Number of cycles for which a signal has a value.
  Cycles cycles_at(const VcdReader& vcd, const std::string& path, std::uint64_t value) const {
    const auto& changes = vcd.signal(path).changes;
    Cycles sum = 0;
    for (std::size_t i = 0; i < changes.size(); ++i) {
      const std::uint64_t end = i + 1 < changes.size() ? changes[i + 1].time : vcd.last_time();
      if (changes[i].value == value) sum += cycle_at(end) - cycle_at(changes[i].time);
    }
    return sum;
  }
  std::vector<std::string> lines(const std::string& name) const {
    std::ifstream in(path(name));
    std::vector<std::string> all;
    for (std::string line; std::getline(in, line);) all.push_back(line);
    return all;
  }

  testbench::RenderOptions options_;

 private:
  test_support::TemporaryDirectory directory_;
};

INSTANTIATE_TEST_SUITE_P(Timing, WaveStatistics,
                         testing::Values(TimingStyle::loosely_timed, TimingStyle::approximately_timed),
                         [](const auto& style) {
                           return style.param == TimingStyle::loosely_timed ? "Loosely" : "Approximately";
                         });

TEST_P(WaveStatistics, ControlUnitsCyclesByCause) {
  const testbench::ChipStatistics chip = run();
  const VcdReader vcd = this->vcd();
  for (int cause = 0; cause < model::kCycleCauses; ++cause)
    EXPECT_EQ(cycles_at(vcd, "control.state", std::uint64_t(cause) + 1),
              chip.control.cycles[std::size_t(cause)])
        << model::cycle_cause_name(static_cast<CycleCause>(cause));
  EXPECT_EQ(cycles_at(vcd, "pe_array.busy", 1),
            chip.control[CycleCause::poly] + chip.control[CycleCause::stolen]);
  EXPECT_EQ(cycles_at(vcd, "control.thread_0.state", std::uint64_t(model::ThreadState::waiting)),
            chip.control[CycleCause::wait_load] + chip.control[CycleCause::wait_save] +
                chip.control[CycleCause::wait_host]);
}

TEST_P(WaveStatistics, CyclesOfEachKernel) {
  options_.chip.pio.stolen_sram_cycles = 0;  // waves count stolen cycles with the kernel
  const testbench::ChipStatistics chip = run();
  const VcdReader vcd = this->vcd();
  std::map<std::string, Cycles> shown;
  for (const std::string& line : lines("run.control_kernel.txt")) {
    const std::size_t blank = line.find(' ');
    shown[line.substr(blank + 1)] = cycles_at(vcd, "control.kernel", std::stoull(line.substr(0, blank)));
  }
  for (const model::KernelStatistics& kernel : chip.kernels) {
    EXPECT_EQ(shown.at(kernel.name), kernel.cycles) << kernel.name;
    EXPECT_GT(kernel.cycles, 0u) << kernel.name;
  }
  EXPECT_EQ(shown.size(), chip.kernels.size() + 1) << "and none";
}

TEST_P(WaveStatistics, RequestsAndBytesOfProgrammedIo) {
  const testbench::ChipStatistics chip = run();
  const VcdReader vcd = this->vcd();
  const auto requests = [&](const std::string& direction) {
    const std::string scope = "pio." + direction;
    std::uint64_t bytes = 0;
    const auto& ids = vcd.signal(scope + "_request").changes;
    for (std::size_t i = 1; i < ids.size(); ++i) bytes += vcd.value_at(scope + "_bytes", ids[i].time);
    return std::pair(ids.size() - 1, bytes);
  };
  EXPECT_EQ(requests("load"), (std::pair(chip.pio.requests_to_poly, chip.pio.bytes_to_poly)));
  EXPECT_EQ(requests("save"), (std::pair(chip.pio.requests_to_mono, chip.pio.bytes_to_mono)));
  EXPECT_EQ(cycles_at(vcd, "pio.loading", 1) + cycles_at(vcd, "pio.saving", 1), chip.pio.busy_cycles());
  EXPECT_EQ(vcd.signal("clear_connect.pio_bytes").changes.back().value, chip.bus_pio.bytes);
}

TEST_P(WaveStatistics, MemoryAndHost) {
  const testbench::ChipStatistics chip = run();
  const VcdReader vcd = this->vcd();
  EXPECT_EQ(cycles_at(vcd, "ddr.data", 1) + cycles_at(vcd, "ddr.data", 2), chip.ddr.busy_cycles);
  std::uint64_t activations = 0;
  for (int bank = 0; bank < options_.chip.ddr.banks; ++bank)
    for (const auto& change : vcd.signal("ddr.bank_" + std::to_string(bank) + ".command").changes)
      activations += change.value == 1 ? 1 : 0;
  EXPECT_EQ(activations, chip.ddr.page_misses);
  EXPECT_EQ(cycles_at(vcd, "host_link.state", 1) + cycles_at(vcd, "host_link.state", 2),
            chip.host_link.busy_cycles);
}

TEST_P(WaveStatistics, LoadsOfTheNextBlockAndSavesOfTheOneBeforeOverlapComputing) {
  run();
  const VcdReader vcd = this->vcd();
  bool next_loads = false;
  bool last_saves = false;
  for (const auto& change : vcd.signal("bins.compute_block").changes) {
    const std::uint64_t at = change.time + 4'000'000;  // shortly after the block begins
    if (vcd.value_at("pe_array.busy", at) == 0 || vcd.value_at("bins.compute_block", at) != change.value)
      continue;
    const auto is = [&](const std::string& part, std::uint64_t block) {
      return vcd.value_at("bins." + part + "_block", at) == block &&
             vcd.value_at("bins." + part + "_stage", at) == vcd.value_at("bins.compute_stage", at);
    };
    next_loads |= vcd.value_at("pio.loading", at) == 1 && is("load", change.value + 1);
    last_saves |= vcd.value_at("pio.saving", at) == 1 && is("save", change.value - 1);
  }
  EXPECT_TRUE(next_loads);
  EXPECT_TRUE(last_saves);
}

TEST_P(WaveStatistics, TransactionLogHoldsEveryRequestAndItsWaits) {
  const testbench::ChipStatistics chip = run();
  std::map<std::string, std::uint64_t> count, bytes;
  std::uint64_t waited = 0, queued = 0, pes = 0, served = 0;
  std::set<std::uint64_t> ids;
  for (const std::string& line : lines("run.jsonl")) {
    const Json entry = Json::parse(line);
    const std::string kind = entry.at("kind");
    ++count[kind];
    bytes[kind] += entry.at("bytes").get<std::uint64_t>();
    const Cycles enqueued = entry.at("enqueued"), started = entry.at("started"),
                 finished = entry.at("finished");
    EXPECT_LE(enqueued, started);
    EXPECT_LT(started, finished);
    waited += entry.at("waited_for").get<Cycles>();
    if (entry.at("request").is_null()) continue;
    EXPECT_TRUE(ids.insert(entry.at("request").get<std::uint64_t>()).second) << line;
    EXPECT_TRUE(entry.at("stage").is_string() && entry.at("block").is_number() &&
                entry.at("semaphore").is_string());
    queued += started - enqueued;
    served += finished - started;
    pes += entry.at("pes").get<std::uint64_t>();
  }
  EXPECT_EQ(count["load"], chip.pio.requests_to_poly);
  EXPECT_EQ(count["save"], chip.pio.requests_to_mono);
  EXPECT_EQ(bytes["load"], chip.pio.bytes_to_poly);
  EXPECT_EQ(bytes["save"], chip.pio.bytes_to_mono);
  EXPECT_EQ(bytes["upload"], chip.host_link.bytes_uploaded);
  EXPECT_EQ(bytes["download"], chip.host_link.bytes_downloaded);
  EXPECT_EQ(pes, chip.pio.pes);
  EXPECT_EQ(queued, chip.pio.queue_wait_cycles);
  EXPECT_EQ(served, chip.pio.busy_cycles());
  EXPECT_EQ(waited, chip.control[CycleCause::wait_load] + chip.control[CycleCause::wait_save]);
  EXPECT_GT(waited, 0u);
  EXPECT_EQ(*ids.rbegin() + 1, ids.size()) << "no request is left out";
}

/// Viewers take whole nanoseconds. With cycles of 4 ns every event begins and ends at one.
TEST_P(WaveStatistics, TimelineInWholeNanosecondsHasNoOverlaps) {
  options_.chip.chip.clock_hz = 250e6;
  run();
  std::map<int, std::int64_t> ends;
  std::size_t events = 0;
  const auto nanoseconds = [](const Json& time) {
    return static_cast<std::int64_t>(time.get<double>() * 1000.0);
  };
  const Json timeline = Json::parse(std::ifstream(path("run.json")));
  for (const Json& event : timeline.at("traceEvents")) {
    if (event.at("ph") != "X") continue;
    const std::int64_t start = nanoseconds(event.at("ts"));
    const std::int64_t duration = nanoseconds(event.at("dur"));
    EXPECT_EQ(start, 4 * event.at("args").at("start_cycle").get<std::int64_t>());
    EXPECT_EQ(duration, 4 * event.at("args").at("cycles").get<std::int64_t>());
    std::int64_t& end = ends[event.at("tid").get<int>()];
    EXPECT_GE(start, end);
    end = start + duration;
    ++events;
  }
  EXPECT_GT(events, 100u);
}

TEST_P(WaveStatistics, TimelineIsWhatItsFormatAsksForAndAddsUp) {
  const testbench::ChipStatistics chip = run();
  const Json timeline = Json::parse(std::ifstream(path("run.json")));
  std::map<int, std::string> tracks;
  std::map<int, Cycles> cycles;
  std::map<int, std::uint64_t> events;
  std::map<int, std::vector<std::pair<double, double>>> spans;
  for (const Json& event : timeline.at("traceEvents")) {
    ASSERT_TRUE(event.at("name").is_string() && event.at("pid").is_number());
    const std::string phase = event.at("ph");
    if (phase == "M") {
      if (event.at("name") == "thread_name") tracks[event.at("tid")] = event.at("args").at("name");
      continue;
    }
    ASSERT_EQ(phase, "X");
    const int track = event.at("tid");
    const double start = event.at("ts"), duration = event.at("dur");
    const Cycles first = event.at("args").at("start_cycle"), length = event.at("args").at("cycles");
    EXPECT_NEAR(start, double(first) * 1e6 / chip.config.chip.clock_hz, 1e-6);
    EXPECT_NEAR(duration, double(length) * 1e6 / chip.config.chip.clock_hz, 2e-6);
    cycles[track] += length;
    ++events[track];
    spans[track].emplace_back(start, start + duration);
  }
  ASSERT_EQ(tracks.size(), 5u);
  for (const auto& [track, name] : tracks) {
    EXPECT_GT(events[track], 0u) << name;
    for (std::size_t i = 1; i < spans[track].size(); ++i)
      EXPECT_LE(spans[track][i - 1].second, spans[track][i].first + 1e-6) << name << ": events overlap";
  }
  using Names = std::map<int, std::string>;
  EXPECT_EQ(tracks, (Names{{1, "kernels"},
                           {2, "control unit waits"},
                           {3, "PIO loads (mono to poly)"},
                           {4, "PIO saves (poly to mono)"},
                           {5, "host transfers"}}));
  EXPECT_EQ(cycles[1], chip.control[CycleCause::poly] + chip.control[CycleCause::stolen]);
  EXPECT_EQ(cycles[2], chip.control.exposed_pio() + chip.control[CycleCause::wait_host] +
                           chip.control[CycleCause::data_cache]);
  EXPECT_EQ(cycles[3] + cycles[4], chip.pio.busy_cycles());
  EXPECT_EQ(events[3], chip.pio.requests_to_poly);
  EXPECT_EQ(events[4], chip.pio.requests_to_mono);
  EXPECT_EQ(cycles[5], chip.host_link.busy_cycles);
}

TEST_P(WaveStatistics, SameRunLeavesTheSameBytes) {
  const auto all = [&] {
    new_context();
    run();
    std::vector<std::vector<std::string>> files;
    for (const char* name : {"run.vcd", "run.gtkw", "run.jsonl", "run.json"}) files.push_back(lines(name));
    return files;
  };
  const auto first = all();
  EXPECT_EQ(all(), first);
  for (const auto& file : first) EXPECT_GT(file.size(), 50u);
}

TEST_P(WaveStatistics, ViewNamesOnlyWhatIsDumped) {
  for (const auto level : {model::WaveLevel::overview, model::WaveLevel::units, model::WaveLevel::detail}) {
    new_context();
    options_.observation.waves->config.selection.level = level;
    run();
    const VcdReader vcd = this->vcd();
    std::set<std::string> viewed;
    for (const std::string& line : lines("run.gtkw")) {
      if (line[0] == '^') {
        EXPECT_TRUE(std::filesystem::exists(path(line.substr(line.find(' ') + 1)))) << line;
      }
      if (line.rfind("+{", 0) != 0) continue;
      const std::string full = line.substr(line.find("} ") + 2);
      const std::string name = full.substr(0, full.find('['));
      ASSERT_EQ(vcd.signals().count(name), 1u) << line;
      const int width = vcd.signals().at(name).width;
      EXPECT_EQ(full, width == 1 ? name : name + "[" + std::to_string(width - 1) + ":0]");
      viewed.insert(name);
    }
    EXPECT_EQ(viewed.size(), vcd.signals().size()) << "and everything that is dumped is viewed";
  }
}

}  // namespace wave_statistics_test
