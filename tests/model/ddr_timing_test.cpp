#include "model/memory/ddr_timing.hpp"

#include <gtest/gtest.h>

#include "tests/support/test_chip.hpp"

namespace ddr_timing_test {

using model::DdrTiming;
constexpr bool kRead = false;
constexpr bool kWrite = true;

model::ChipConfig::Ddr ddr() {
  return test_support::test_chip().ddr;
}

void expect_access(const DdrTiming::Access& access, model::Cycles start, model::Cycles finish,
                   bool page_hit) {
  EXPECT_EQ(access.start, start);
  EXPECT_EQ(access.finish, finish);
  EXPECT_EQ(access.page_hit, page_hit);
}

TEST(DdrTiming, FirstAccessMissesAndNextHitFollowsWithoutAGap) {
  DdrTiming timing(ddr());
  expect_access(timing.access(0, 64, kRead, 100), 130, 134, false);
  expect_access(timing.access(64, 64, kRead, 100), 134, 138, true);
}

TEST(DdrTiming, HitOnIdleMemoryPaysItsLatency) {
  DdrTiming timing(ddr());
  timing.access(0, 64, kRead, 0);
  expect_access(timing.access(128, 32, kRead, 1000), 1020, 1022, true);
}

TEST(DdrTiming, MissInTheSameBankLeavesTheBusIdleForTheDifference) {
  DdrTiming timing(ddr());
  expect_access(timing.access(0, 64, kRead, 0), 30, 34, false);
  expect_access(timing.access(2048, 64, kRead, 0), 44, 48, false);  // row 1 of bank 0
  expect_access(timing.access(0, 64, kRead, 0), 58, 62, false);     // row 0 was closed
}

TEST(DdrTiming, MissesInDifferentBanksOverlap) {
  DdrTiming timing(ddr());
  expect_access(timing.access(0, 64, kRead, 0), 30, 34, false);
  expect_access(timing.access(512, 64, kRead, 0), 34, 38, false);
  expect_access(timing.access(1024, 64, kRead, 0), 38, 42, false);
}

TEST(DdrTiming, ABankKeepsItsRowUntilALongTransferIsOver) {
  DdrTiming timing(ddr());
  expect_access(timing.access(0, 512, kRead, 0), 30, 62, false);
  // The row may change at 62 - 20; the other bank's transfer has long been possible by then.
  expect_access(timing.access(2048, 16, kRead, 0), 72, 73, false);
}

TEST(DdrTiming, AccessIsSplitAtPages) {
  DdrTiming timing(ddr());
  expect_access(timing.access(448, 128, kRead, 0), 30, 38, false);
  EXPECT_EQ(timing.statistics().page_misses, 2u);
  expect_access(timing.access(448, 128, kRead, 100), 120, 128, true);
  EXPECT_EQ(timing.statistics().page_hits, 2u);
}

TEST(DdrTiming, LongAccessRunsThroughAllBanksAndIntoTheNextRow) {
  DdrTiming timing(ddr());
  // Banks 1, 2, 3 open while bank 0 transfers; row 1 of bank 0 can be opened from 62 - 20 on, ready at 72 <
  // 158.
  expect_access(timing.access(0, 2560, kRead, 0), 30, 190, false);
  EXPECT_EQ(timing.statistics().page_misses, 5u);
  EXPECT_EQ(timing.statistics().busy_cycles, 160u);
}

TEST(DdrTiming, ContiguousPiecesCostAsMuchAsTheWhole) {
  DdrTiming whole(ddr());
  DdrTiming pieces(ddr());
  const auto at_once = whole.access(256, 1024, kWrite, 10);
  DdrTiming::Access last{};
  for (std::uint64_t address = 256; address < 1280; address += 64)
    last = pieces.access(address, 64, kWrite, 10);
  EXPECT_EQ(at_once.finish, 10u + 30u + 64u);
  EXPECT_EQ(last.finish, at_once.finish);
}

TEST(DdrTiming, PartOfACycleCountsAsOne) {
  DdrTiming timing(ddr());
  expect_access(timing.access(0, 24, kRead, 0), 30, 32, false);
  expect_access(timing.access(32, 8, kRead, 0), 32, 33, true);
}

TEST(DdrTiming, NoBytesCostNothing) {
  DdrTiming timing(ddr());
  expect_access(timing.access(0, 0, kRead, 7), 7, 7, true);
  EXPECT_EQ(timing.statistics().page_misses, 0u);
}

TEST(DdrTiming, ChangeOfDirectionTurnsTheBusRound) {
  DdrTiming timing(ddr());
  timing.access(0, 64, kRead, 0);  // 30..34
  expect_access(timing.access(64, 64, kWrite, 0), 38, 42, true);
  expect_access(timing.access(128, 64, kWrite, 0), 42, 46, true);
  expect_access(timing.access(192, 64, kRead, 0), 50, 54, true);
  EXPECT_EQ(timing.statistics().turn_rounds, 2u);
  expect_access(timing.access(0, 64, kWrite, 500), 520, 524, true);  // long over by then
  EXPECT_EQ(timing.statistics().turn_rounds, 3u);
}

TEST(DdrTiming, RefreshClosesRowsAndOccupiesAllBanks) {
  auto config = ddr();
  config.refresh_interval_cycles = 1000;
  config.refresh_cycles = 50;
  DdrTiming timing(config);
  expect_access(timing.access(0, 64, kRead, 900), 930, 934, false);
  expect_access(timing.access(0, 64, kRead, 999), 1019, 1023, true);
  expect_access(timing.access(0, 64, kRead, 1020), 1103, 1107, false);  // put off to 1023, over at 1073
  EXPECT_EQ(timing.statistics().refreshes, 1u);
}

TEST(DdrTiming, RefreshComesBetweenPagesOfABacklog) {
  auto config = ddr();
  config.refresh_interval_cycles = 1000;
  config.refresh_cycles = 50;
  DdrTiming timing(config);
  // Pages at 930..962, 962..994, 994..1026; refresh until 1076, then a miss: 1106..1138.
  expect_access(timing.access(0, 2048, kRead, 900), 930, 1138, false);
  EXPECT_EQ(timing.statistics().refreshes, 1u);
}

TEST(DdrTiming, RefreshesOfAnIdleTimeAreCountedAndOnlyTheLatestIsFelt) {
  auto config = ddr();
  config.refresh_interval_cycles = 1000;
  config.refresh_cycles = 50;
  DdrTiming timing(config);
  expect_access(timing.access(0, 64, kRead, 3010), 3080, 3084, false);
  EXPECT_EQ(timing.statistics().refreshes, 3u);
  expect_access(timing.access(0, 64, kRead, 4500), 4530, 4534, false);
  EXPECT_EQ(timing.statistics().refreshes, 4u);
  expect_access(timing.access(64, 64, kRead, 4500), 4534, 4538, true);
}

TEST(DdrTiming, EccLengthensLatencyOnly) {
  auto config = ddr();
  config.ecc_cycles = 3;
  DdrTiming timing(config);
  expect_access(timing.access(0, 64, kRead, 0), 30, 37, false);
  expect_access(timing.access(64, 64, kRead, 0), 34, 41, true);
}

TEST(DdrTiming, PagesAndBanksNeedNotBePowersOfTwo) {
  auto config = ddr();
  config.page_bytes = 384;
  config.banks = 3;
  config.bytes_per_cycle = 12;
  DdrTiming timing(config);
  expect_access(timing.access(0, 120, kRead, 0), 30, 40, false);
  expect_access(timing.access(360, 12, kRead, 0), 40, 41, true);
  expect_access(timing.access(384, 12, kRead, 0), 41, 42, false);
  expect_access(timing.access(1152, 12, kRead, 0), 51, 52, false);  // row 1 of bank 0; changes at 41 - 20
}

TEST(DdrTiming, CountsBytesByDirection) {
  DdrTiming timing(ddr());
  timing.access(0, 96, kRead, 0);
  timing.access(0, 40, kWrite, 0);
  EXPECT_EQ(timing.statistics().bytes_read, 96u);
  EXPECT_EQ(timing.statistics().bytes_written, 40u);
  EXPECT_EQ(timing.statistics().busy_cycles, 6u + 3u);
  EXPECT_EQ(timing.statistics().refreshes, 0u);
}

}  // namespace ddr_timing_test
