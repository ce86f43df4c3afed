// Boards of several chips behind one host link, and chips of several arrays: the image is that of one array,
// the work is divided, counts and energy are summed.

#include <numeric>

#include "testbench/run/energy.hpp"
#include "testbench/run/render.hpp"
#include "testbench/sampling/sample_counts.hpp"
#include "testbench/system/error.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/systemc_fixture.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/vcd_reader.hpp"

namespace board_test {

using model::Cycles;
using model::TimingStyle;
using path_tracer::Program;
using testbench::ChipStatistics;
using testbench::RenderOptions;
using testbench::RenderResult;

class Board : public test_support::SystemCFixture, public testing::WithParamInterface<TimingStyle> {
 protected:
  RenderResult render(int chips, int arrays = 1) {
    new_context();
    options.chip.board.chips = chips;
    options.chip.chip.arrays = arrays;
    return testbench::render_on_chip(scene, options);
  }
  testbench::Scene scene = test_support::small_cornell_box({24, 20});
  RenderOptions options = [] {
    RenderOptions some = test_support::render_options(Program::full, 16);
    some.timing = GetParam();
    return some;
  }();
};

TEST_P(Board, GivesTheImageOfOneChipSooner) {
  const RenderResult one = render(1);
  EXPECT_TRUE(one.chips.empty());
  for (const int chips : {2, 4}) {
    const RenderResult several = render(chips);
    EXPECT_EQ(several.film.sha256(), one.film.sha256());
    EXPECT_EQ(several.counts.segments, one.counts.segments);
    EXPECT_EQ(several.counts.shadow_rays, one.counts.shadow_rays);
    EXPECT_EQ(several.counts.paths_by_segments, one.counts.paths_by_segments);
    EXPECT_EQ(several.chips.size(), std::size_t(chips));
    const double speedup = double(one.chip->firmware_cycles) / double(several.chip->firmware_cycles);
    EXPECT_GT(speedup, 0.6 * chips);
    EXPECT_LT(speedup, 1.02 * chips);
  }
}

TEST_P(Board, TwoArraysOfAChipGiveTheImageOfOneSooner) {
  const RenderResult one = render(1);
  const RenderResult two = render(1, 2);
  EXPECT_EQ(two.film.sha256(), one.film.sha256());
  EXPECT_EQ(two.counts.segments, one.counts.segments);
  EXPECT_TRUE(two.chips.empty()) << "they are one chip";
  const double speedup = double(one.chip->firmware_cycles) / double(two.chip->firmware_cycles);
  EXPECT_GT(speedup, 1.2);
  EXPECT_LT(speedup, 2.04);
  EXPECT_LT(two.chip->host_link.bytes_uploaded, one.chip->host_link.bytes_uploaded + 1000)
      << "they share the scene";
  EXPECT_LE(two.chip->pe_utilisation(), 1.0);
  EXPECT_EQ(render(2, 2).film.sha256(), one.film.sha256());
}

/// Each chip gets the whole scene, and the uploads come one after the other.
TEST_P(Board, ChipsTakeTurnsOnTheHostLink) {
  const RenderResult two = render(2);
  const model::HostLinkStatistics& first = two.chips[0].host_link;
  const model::HostLinkStatistics& second = two.chips[1].host_link;
  EXPECT_EQ(first.bytes_uploaded, second.bytes_uploaded);
  EXPECT_LE(first.busy_cycles + second.busy_cycles,
            std::max(two.chips[0].total_cycles, two.chips[1].total_cycles));
  const double upload_cycles =
      double(first.bytes_uploaded) / options.chip.host.bytes_per_second * options.chip.chip.clock_hz;
  EXPECT_GT(double(two.chips[1].total_cycles - two.chips[1].firmware_cycles), 2 * upload_cycles);
}

/// What goes to the second chip crosses a bridge; the first is at the link.
TEST_P(Board, ANarrowBridgeHoldsUpTheSecondChip) {
  const RenderResult wide = render(2);
  options.chip.board.bridge_bytes_per_cycle = 1;
  options.chip.board.bridge_clock_hz = 5e6;  // a 160th of the host link
  const RenderResult narrow = render(2);
  EXPECT_EQ(narrow.film.sha256(), wide.film.sha256());
  EXPECT_GT(narrow.chips[1].host_link.busy_cycles, 10 * wide.chips[1].host_link.busy_cycles);
  EXPECT_LT(narrow.chips[0].host_link.busy_cycles, 1.01 * double(wide.chips[0].host_link.busy_cycles));
}

std::uint64_t sum(const std::vector<ChipStatistics>& chips, std::uint64_t (*of)(const ChipStatistics&)) {
  return std::accumulate(chips.begin(), chips.end(), std::uint64_t{0},
                         [of](std::uint64_t all, const ChipStatistics& chip) { return all + of(chip); });
}

TEST_P(Board, CountsAreTheSumOfItsChips) {
  const RenderResult board = render(4);
  const auto expect_sum = [&](std::uint64_t (*of)(const ChipStatistics&)) {
    EXPECT_EQ(of(*board.chip), sum(board.chips, of));
    EXPECT_GT(of(*board.chip), of(board.chips[0]));
  };
  expect_sum([](const ChipStatistics& c) { return c.control.total(); });
  expect_sum([](const ChipStatistics& c) { return c.pio.bytes_to_poly; });
  expect_sum([](const ChipStatistics& c) { return c.poly_sram.words_in; });
  expect_sum([](const ChipStatistics& c) { return c.ddr.bytes_read; });
  expect_sum([](const ChipStatistics& c) { return c.bus_pio.packets; });
  expect_sum([](const ChipStatistics& c) { return c.host_link.bytes_downloaded; });
  expect_sum([](const ChipStatistics& c) { return c.all_kernels.runs; });
  expect_sum([](const ChipStatistics& c) { return std::uint64_t(c.kernels.front().cycles); });
  EXPECT_LE(board.chip->pe_utilisation(), 1.0);
  EXPECT_LE(board.chip->simd_efficiency(), 1.0);
  for (const ChipStatistics& chip : board.chips) {
    EXPECT_EQ(chip.control.total(), chip.firmware_cycles);
    EXPECT_LE(chip.firmware_cycles, board.chip->firmware_cycles);
    EXPECT_LE(chip.total_cycles, board.chip->total_cycles);
  }
}

/// Every chip is on until the last has finished.
TEST_P(Board, EnergyIsTheSumOfItsChips) {
  const RenderResult board = render(2);
  double joules = 0;
  for (ChipStatistics chip : board.chips) {
    chip.total_cycles = board.chip->total_cycles;
    joules += testbench::energy_of(chip).joules();
  }
  EXPECT_NEAR(testbench::energy_of(*board.chip).joules(), joules, 1e-12 * joules);
}

/// Arrays share a DDR, so it leaks once, and its accesses are counted once.
TEST_P(Board, TheDdrThatTwoArraysShareCountsOnce) {
  const RenderResult one = render(1);
  const RenderResult two = render(1, 2);
  ChipStatistics as_one = *two.chip;
  as_one.config.chip.arrays = 1;
  EXPECT_EQ(testbench::energy_of(*two.chip).ddr_joules(), testbench::energy_of(as_one).ddr_joules());
  EXPECT_GT(testbench::energy_of(*two.chip).chip_joules(), testbench::energy_of(as_one).chip_joules());
  const auto bytes = [](const ChipStatistics& chip) {
    return chip.bus_pio.bytes + chip.bus_control.bytes + chip.bus_host.bytes;
  };
  EXPECT_EQ(two.chip->ddr.bytes_read + two.chip->ddr.bytes_written, bytes(*two.chip));
  EXPECT_EQ(one.chip->ddr.bytes_read + one.chip->ddr.bytes_written, bytes(*one.chip));
}

TEST_P(Board, WithFewerSamplesThanArraysPathsAreDivided) {
  options.work.samples = 1;
  const RenderResult one = render(1);
  for (const auto& [chips, arrays] : {std::pair(2, 1), std::pair(4, 1), std::pair(2, 2)}) {
    const RenderResult several = render(chips, arrays);
    EXPECT_EQ(several.film.sha256(), one.film.sha256());
    EXPECT_LT(several.chip->firmware_cycles, one.chip->firmware_cycles);
  }
}

TEST_P(Board, AListOfSamplesIsDivided) {
  const auto pixels = std::size_t(scene.film.width * scene.film.height);
  testbench::SampleCounts counts(pixels, 2);
  for (std::size_t i = 0; i < pixels; i += 3) counts[i] = 5;
  options.camera_samples = testbench::list_samples(testbench::SampleCounts(pixels, 0), counts, 1);
  const RenderResult one = render(1);
  EXPECT_EQ(render(2).film.sha256(), one.film.sha256());
  EXPECT_EQ(render(1, 2).film.sha256(), one.film.sha256());
}

TEST_P(Board, RefusesMoreArraysThanPaths) {
  scene.film = {1, 1};
  options.work.samples = 1;
  EXPECT_THROW(render(2), testbench::InputError);
}

TEST_P(Board, RefusesBinsThatDoNotFitBesideEachOther) {
  new_context();
  const std::uint64_t bytes = testbench::make_image(scene, options)->layout.total_bytes;
  options.chip.ddr.size_bytes = (bytes / (1 << 20) + 1) << 20;
  EXPECT_NO_THROW(render(1));
  EXPECT_THROW(render(1, 4), testbench::InputError);
}

TEST_P(Board, TheWavesOfEachArrayHaveItsScope) {
  const test_support::TemporaryDirectory directory;
  const RenderResult unobserved = render(2, 2);
  options.observation.waves.emplace(testbench::WaveOptions{directory.path() / "a.vcd", {}});
  const RenderResult observed = render(2, 2);
  EXPECT_EQ(observed.observation_failures, "");
  EXPECT_EQ(observed.chip->firmware_cycles, unobserved.chip->firmware_cycles);
  for (const char* array : {"csx600_0_array_0", "csx600_0_array_1", "csx600_1_array_0", "csx600_1_array_1"}) {
    const auto waves =
        test_support::VcdReader::of_file(directory.path() / ("a." + std::string(array) + ".vcd"));
    for (const auto& signal : waves.signals()) EXPECT_EQ(signal.first.rfind(std::string(array) + ".", 0), 0u);
    EXPECT_GT(waves.signal(std::string(array) + ".control.state").changes.size(), 100u);
  }
}

INSTANTIATE_TEST_SUITE_P(Styles, Board,
                         testing::Values(TimingStyle::loosely_timed, TimingStyle::approximately_timed),
                         [](const testing::TestParamInfo<TimingStyle>& style) {
                           return style.param == TimingStyle::loosely_timed ? "Lt" : "At";
                         });

}  // namespace board_test
