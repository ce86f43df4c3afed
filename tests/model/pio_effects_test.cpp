// What the memory and the engine can do to a request, each alone on the whole way from the engine's port to
// the memory and back, in both styles of timing.

#include <algorithm>
#include <array>

#include "tests/support/pio_bench.hpp"

namespace pio_effects_test {

using cn::LaneMask;
using cn::MonoPlaces;
using model::ChipConfig;
using model::Cycles;
using model::TimingStyle;
using test_support::kAll;
using test_support::kPes;
using test_support::test_chip;

/// A chip whose memory is the bottleneck, so that none of its time hides behind the PEs.
ChipConfig memory_bound_chip() {
  ChipConfig config = test_chip();
  config.pio.setup_cycles = 0;
  config.pio.per_pe_cycles = 0;
  config.clear_connect.hop_cycles = 0;
  config.ddr.page_hit_cycles = 20;
  config.ddr.page_miss_cycles = 60;
  return config;
}

/// A chip of its own for each measurement.
class Bench : public test_support::PioBench {
 public:
  using PioBench::read;
  using PioBench::write;

  /// When all of `transfers`, queued at cycle 0 one after the other, are over.
  Cycles end_of(const ChipConfig& config, TimingStyle timing, std::vector<cn::Transfer> transfers) {
    build(config, timing);
    Cycles end = 0;
    run([&] {
      Cycles now = 0;
      for (std::size_t i = 0; i < transfers.size(); ++i) {
        transfers[i].done = {static_cast<int>(i)};
        now = engine->enqueue(transfers[i], now);
      }
      serve_all();
    });
    for (const auto& [semaphore, at] : semaphores.signals) end = std::max(end, at.back());
    return end;
  }
  const model::DdrStatistics& memory() const { return ddr->statistics(); }

 private:
  void TestBody() override {}
};

cn::Transfer read(const MonoPlaces& from, int bytes, const LaneMask& enabled) {
  return Bench::read(from, bytes, enabled);
}
cn::Transfer write(const MonoPlaces& to, int bytes, const LaneMask& enabled) {
  return Bench::write(to, bytes, enabled);
}

class PioEffects : public testing::TestWithParam<TimingStyle> {
 protected:
  Cycles end_of(const ChipConfig& config, const std::vector<cn::Transfer>& transfers) {
    Bench bench;
    const Cycles end = bench.end_of(config, GetParam(), transfers);
    ddr_statistics = bench.memory();
    return end;
  }
  static MonoPlaces gather(std::array<cn::MonoAddress, kPes>& by_pe, std::uint64_t stride_bytes) {
    for (std::size_t pe = 0; pe < by_pe.size(); ++pe) by_pe[pe] = pe * stride_bytes;
    return MonoPlaces::each(by_pe.data());
  }
  std::array<cn::MonoAddress, kPes> by_pe_{};
  model::DdrStatistics ddr_statistics;
};

TEST_P(PioEffects, RowsOfOneBankAreOpenedOneAfterTheOther) {
  const auto config = memory_bound_chip();
  const Cycles one_row = end_of(config, {read(gather(by_pe_, 64), 32, kAll)});
  EXPECT_EQ(ddr_statistics.page_misses, 1u);
  const Cycles eight_rows = end_of(config, {read(gather(by_pe_, 2048), 32, kAll)});  // 4 banks of 512 bytes
  EXPECT_EQ(ddr_statistics.page_misses, 8u);
  // 40 cycles to close and open a row, for each but the first.
  EXPECT_NEAR(double(eight_rows - one_row), 7 * 40.0, 20.0);
}

TEST_P(PioEffects, RowsOfDifferentBanksAreOpenedSideBySide) {
  const auto config = memory_bound_chip();
  const Cycles one_bank = end_of(config, {read(gather(by_pe_, 2048), 32, LaneMask::first(4))});
  const Cycles four_banks = end_of(config, {read(gather(by_pe_, 512), 32, LaneMask::first(4))});
  EXPECT_EQ(ddr_statistics.page_misses, 4u);
  EXPECT_NEAR(double(one_bank - four_banks), 3 * 40.0, 15.0);
}

TEST_P(PioEffects, MoreBanksHelp) {
  auto config = memory_bound_chip();
  config.ddr.banks = 1;
  const Cycles one = end_of(config, {read(gather(by_pe_, 512), 32, kAll)});
  config.ddr.banks = 8;
  const Cycles eight = end_of(config, {read(gather(by_pe_, 512), 32, kAll)});
  EXPECT_NEAR(double(one - eight), 7 * 40.0, 30.0);
}

TEST_P(PioEffects, RefreshHoldsUpRequests) {
  auto config = memory_bound_chip();
  config.ddr.bytes_per_cycle = 1;
  const std::vector<cn::Transfer> reads(2, read(MonoPlaces::array(0, 128), 128, kAll));
  const Cycles without = end_of(config, reads);
  config.ddr.refresh_interval_cycles = 500;
  config.ddr.refresh_cycles = 100;
  const Cycles with = end_of(config, reads);
  // 2048 bytes take 2048 cycles: three refreshes or more, each of 100 cycles and a closed row.
  EXPECT_GE(ddr_statistics.refreshes, 3u);
  EXPECT_GE(with - without, 3u * 100);
  EXPECT_LE(with - without, (ddr_statistics.refreshes + 1) * 170);
}

TEST_P(PioEffects, DataBusTurnsRoundBetweenReadsAndWrites) {
  auto config = memory_bound_chip();
  config.pio.queue_depth = 8;
  config.ddr.bytes_per_cycle = 1;
  std::vector<cn::Transfer> alternating;
  for (int i = 0; i < 3; ++i) {
    alternating.push_back(write(MonoPlaces::array(0, 32), 32, kAll));
    alternating.push_back(read(MonoPlaces::array(0, 32), 32, kAll));
  }
  config.ddr.turn_round_cycles = 0;
  const Cycles without = end_of(config, alternating);
  config.ddr.turn_round_cycles = 100;
  const Cycles with = end_of(config, alternating);
  EXPECT_GE(ddr_statistics.turn_rounds, 5u);
  // Part of each turn hides behind the latency of what comes next.
  EXPECT_GE(with - without, 5u * 50);
  EXPECT_LE(with - without, ddr_statistics.turn_rounds * 100);
}

TEST_P(PioEffects, ConsolidationFetchesEqualAddressesOnce) {
  auto config = test_chip();
  const auto broadcast = read(MonoPlaces::array(64, 0), 32, kAll);
  const Cycles each = end_of(config, {broadcast});
  EXPECT_EQ(ddr_statistics.bytes_read, 256u);
  config.pio.consolidate_equal_addresses = true;
  const Cycles once = end_of(config, {broadcast});
  EXPECT_EQ(ddr_statistics.bytes_read, 32u);
  // 100 + 8 x 14; approximately timed the last PE's own packet leaves at 180 and pays 40 of latency, a hit.
  EXPECT_EQ(each, GetParam() == TimingStyle::loosely_timed ? 212u : 220u);
  EXPECT_EQ(once, 160u);  // as for one PE, with the whole latency
}

TEST_P(PioEffects, ConsolidationLeavesDifferentAddressesAlone) {
  auto config = test_chip();
  const auto different = read(gather(by_pe_, 64), 32, kAll);
  const Cycles without = end_of(config, {different});
  config.pio.consolidate_equal_addresses = true;
  EXPECT_EQ(end_of(config, {different}), without);
}

INSTANTIATE_TEST_SUITE_P(Styles, PioEffects,
                         testing::Values(TimingStyle::loosely_timed, TimingStyle::approximately_timed),
                         [](const testing::TestParamInfo<TimingStyle>& style) {
                           return style.param == TimingStyle::loosely_timed ? "Lt" : "At";
                         });

}  // namespace pio_effects_test
