// A chip with several arrays on one network: they share its memories in the order of time, each with
// firmware, PIO engine and statistics of its own.

#include <cmath>

#include "model/csx600.hpp"
#include "tests/support/systemc_fixture.hpp"
#include "tests/support/test_chip.hpp"

namespace several_arrays_test {

using model::Cycles;
using model::TimingStyle;

constexpr int kRounds = 300;
constexpr int kBytesPerPe = 256;
constexpr std::uint64_t kRegionBytes = 64 * 1024;

/// Loads one buffer while it saves the other: nothing but memory accesses.
void stream(cn::Machine& machine, cn::MonoAddress first) {
  const cn::Semaphore loaded = machine.allocate_semaphore("loaded");
  const cn::Semaphore saved = machine.allocate_semaphore("saved");
  const cn::PolySpan buffer = machine.poly_memory().allocate("buffer", kBytesPerPe);
  const cn::LaneMask all = cn::LaneMask::first(machine.num_pes());
  for (int round = 0; round < kRounds; ++round) {
    const cn::MonoAddress place =
        first + std::uint64_t(round % 16) * std::uint64_t(machine.num_pes()) * kBytesPerPe;
    machine.async_copy_m2p(loaded, buffer, cn::MonoPlaces::array(place, kBytesPerPe), all);
    machine.sem_wait(loaded);
    machine.async_copy_p2m(saved, cn::MonoPlaces::array(place, kBytesPerPe), buffer, all);
    machine.sem_wait(saved);
  }
}

struct Outcome {
  std::vector<Cycles> cycles;
  model::DdrStatistics ddr;
  std::vector<std::uint64_t> network_bytes;
};

/// @param ddr_bytes_per_cycle 1: an array alone fills the DDR
Outcome run(TimingStyle timing, int arrays, int running, int ddr_bytes_per_cycle) {
  model::ChipConfig config = test_support::test_chip();
  config.chip.arrays = arrays;
  config.pio.setup_cycles = 0;
  config.pio.per_pe_cycles = 0;
  config.ddr.bytes_per_cycle = ddr_bytes_per_cycle;
  model::Csx600 chip("chip", config, timing);
  for (int i = 0; i < running; ++i) {
    model::ControlUnit& control_unit = chip.array(i).control_unit;
    control_unit.load([i](cn::Machine& machine) { stream(machine, std::uint64_t(i) * kRegionBytes); });
    control_unit.start();
  }
  sc_core::sc_start(sc_core::sc_time(1, sc_core::SC_SEC), sc_core::SC_EXIT_ON_STARVATION);
  Outcome outcome{{}, chip.ddr_statistics(), {}};
  for (int i = 0; i < running; ++i) {
    chip.array(i).control_unit.require_finished();
    EXPECT_EQ(chip.array(i).pio_engine.statistics().late_starts, 0u);
    outcome.cycles.push_back(chip.array(i).control_unit.statistics().total());
    outcome.network_bytes.push_back(chip.clear_connect.statistics(chip.array(i).pio).bytes);
  }
  return outcome;
}

double difference(Cycles a, Cycles b) {
  return std::abs(double(a) / double(b) - 1);
}

class SeveralArrays : public test_support::SystemCFixture, public testing::WithParamInterface<TimingStyle> {};

TEST_P(SeveralArrays, AloneAnArrayIsAChipOfOne) {
  const Cycles one = run(GetParam(), 1, 1, 16).cycles[0];
  new_context();
  EXPECT_EQ(run(GetParam(), 2, 1, 16).cycles[0], one);
}

TEST_P(SeveralArrays, EqualOnesShareAFullMemoryEqually) {
  const Cycles alone = run(GetParam(), 1, 1, 1).cycles[0];
  for (const int arrays : {2, 3, 4}) {
    new_context();
    const Outcome outcome = run(GetParam(), arrays, arrays, 1);
    for (const Cycles cycles : outcome.cycles) {
      EXPECT_LT(difference(cycles, Cycles(arrays) * alone), 0.06) << arrays;
      EXPECT_LT(difference(cycles, outcome.cycles[0]), 0.01) << arrays;
    }
  }
}

TEST_P(SeveralArrays, AWideMemoryHoldsUpNobodyMuch) {
  const Cycles alone = run(GetParam(), 1, 1, 4096).cycles[0];
  new_context();
  for (const Cycles cycles : run(GetParam(), 2, 2, 4096).cycles) EXPECT_LT(difference(cycles, alone), 0.35);
}

/// Its energy comes from these counts, so a shared memory's is counted once.
TEST_P(SeveralArrays, TheSharedMemoryCountsEachByteOnce) {
  const Outcome outcome = run(GetParam(), 2, 2, 16);
  const std::uint64_t bytes = std::uint64_t(kRounds) * 8 * kBytesPerPe;
  EXPECT_EQ(outcome.ddr.bytes_read, 2 * bytes);
  EXPECT_EQ(outcome.ddr.bytes_written, 2 * bytes);
  EXPECT_EQ(outcome.network_bytes, (std::vector<std::uint64_t>{2 * bytes, 2 * bytes}));
}

TEST_F(SeveralArrays, BothTimingStylesAgree) {
  for (const int bytes_per_cycle : {1, 2, 16}) {
    new_context();
    const Outcome loose = run(TimingStyle::loosely_timed, 2, 2, bytes_per_cycle);
    new_context();
    const Outcome approximate = run(TimingStyle::approximately_timed, 2, 2, bytes_per_cycle);
    for (std::size_t i = 0; i < 2; ++i)
      EXPECT_LT(difference(loose.cycles[i], approximate.cycles[i]), 0.05) << bytes_per_cycle;
  }
}

INSTANTIATE_TEST_SUITE_P(Styles, SeveralArrays,
                         testing::Values(TimingStyle::loosely_timed, TimingStyle::approximately_timed),
                         [](const testing::TestParamInfo<TimingStyle>& style) {
                           return style.param == TimingStyle::loosely_timed ? "Lt" : "At";
                         });

}  // namespace several_arrays_test
