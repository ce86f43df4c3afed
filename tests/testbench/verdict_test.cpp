// Which unit held a run up, from what the chip counted.

#include "testbench/statistics/verdict.hpp"

#include <gtest/gtest.h>

#include "model/config/chip_presets.hpp"

namespace verdict_test {

using model::CycleCause;
using testbench::ChipStatistics;
using testbench::UnitUse;
using testbench::Verdict;
using testbench::verdict_of;

/// 1000 cycles of firmware: 400 of kernels, 550 of waits for loads, 50 of mono code.
ChipStatistics waiting_run() {
  ChipStatistics run;
  run.config = model::preset("csx600");
  run.firmware_cycles = 1000;
  run.total_cycles = 1250;
  run.control.cycles[std::size_t(CycleCause::poly)] = 390;
  run.control.cycles[std::size_t(CycleCause::stolen)] = 10;
  run.control.cycles[std::size_t(CycleCause::wait_load)] = 550;
  run.control.cycles[std::size_t(CycleCause::mono)] = 50;
  run.pio.pe_cycles = 600;
  run.pio.memory_wait_cycles = 250;
  run.pio.setup_cycles = 100;
  run.ddr.busy_cycles = 120;
  run.host_link.busy_cycles = 125;
  const auto add_kernel = [&](const char* name, model::Cycles cycles, model::Cycles waited) {
    model::KernelStatistics kernel;
    kernel.name = name;
    kernel.cycles = cycles;
    kernel.waited_before.load = waited;
    run.kernels.push_back(kernel);
  };
  add_kernel("short", 40, 0);
  add_kernel("long", 300, 150);
  add_kernel("starved", 50, 400);
  return run;
}

TEST(VerdictOfARun, SharesAreOfTheFirmwaresTime) {
  const Verdict verdict = verdict_of(waiting_run());
  EXPECT_DOUBLE_EQ(verdict.share_of("pe_array"), 0.4);
  EXPECT_DOUBLE_EQ(verdict.share_of("pio"), 0.95);
  EXPECT_DOUBLE_EQ(verdict.share_of("ddr"), 0.12);
  EXPECT_DOUBLE_EQ(verdict.share_of("control_unit"), 0.05);
  EXPECT_DOUBLE_EQ(verdict.share_of("host_link"), 0.1);
  EXPECT_DOUBLE_EQ(verdict.share_of("on_chip_sram"), 0);
}

TEST(VerdictOfARun, NamesTheBusiestUnitItsPartsAndWhoWaits) {
  const Verdict verdict = verdict_of(waiting_run());
  EXPECT_EQ(verdict.critical, "pio");
  EXPECT_EQ(verdict.reason,
            "pio is busy 95.0 % of the time (60.0 % turns of PEs, 25.0 % memory, 10.0 % setup); the PE array "
            "waits for programmed I/O 55.0 % of the time, most before starved (40.0 %) and long (15.0 %)");
}

TEST(VerdictOfARun, TwoEnginesAreEachBusyHalfAsLong) {
  ChipStatistics run = waiting_run();
  run.config.pio.arbitration = model::PioArbitration::queue_per_direction;
  EXPECT_DOUBLE_EQ(verdict_of(run).share_of("pio"), 0.475);
}

/// What the I/O engine waits for answers of a search unit is that unit's time.
TEST(VerdictOfARun, ASearchUnitThatIsWaitedForIsTheVerdict) {
  ChipStatistics run = waiting_run();
  for (const UnitUse& unit : verdict_of(run).units) EXPECT_NE(unit.name, "search_unit");
  run.config.search_unit.units = 2;
  run.search_unit.busy_cycles = 1800;
  run.search_unit.answer_wait_cycles = 200;
  const Verdict verdict = verdict_of(run);
  EXPECT_DOUBLE_EQ(verdict.share_of("search_unit"), 0.9);
  EXPECT_DOUBLE_EQ(verdict.share_of("pio"), 0.75);
  EXPECT_EQ(verdict.critical, "search_unit");
  EXPECT_EQ(verdict.reason, "search_unit is busy 90.0 % of the time");
}

TEST(VerdictOfARun, OfABoardSharesAreMeans) {
  ChipStatistics run = waiting_run();
  run.config.board.chips = 2;
  run.config.chip.arrays = 2;
  const Verdict verdict = verdict_of(run);
  EXPECT_DOUBLE_EQ(verdict.share_of("pe_array"), 0.1);
  EXPECT_DOUBLE_EQ(verdict.share_of("pio"), 0.2375);
  EXPECT_DOUBLE_EQ(verdict.share_of("ddr"), 0.06);
}

TEST(VerdictOfARun, KernelsThatTakeAllTheTimeAreTheVerdict) {
  ChipStatistics run = waiting_run();
  run.control.cycles[std::size_t(CycleCause::poly)] = 940;
  run.control.cycles[std::size_t(CycleCause::wait_load)] = 0;
  run.pio.pe_cycles = 100;
  const Verdict verdict = verdict_of(run);
  EXPECT_EQ(verdict.critical, "pe_array");
  EXPECT_EQ(verdict.reason.rfind("pe_array is busy 95.0 % of the time (long 30.0 %, starved 5.0 %), ", 0), 0u)
      << verdict.reason;
}

TEST(VerdictOfARun, UnitsThatTakeTurnsAreNotCalledBusy) {
  ChipStatistics run = waiting_run();
  run.pio.pe_cycles = 200;
  const Verdict verdict = verdict_of(run);
  EXPECT_EQ(verdict.critical, "pio");
  EXPECT_EQ(verdict.reason.rfind("no unit is busy for more than 55.0 % of the time (pio): they wait", 0), 0u)
      << verdict.reason;
}

TEST(VerdictOfARun, ARunWithoutTimeHasNoShares) {
  ChipStatistics run;
  run.config = model::preset("csx600");
  for (const UnitUse& use : verdict_of(run).units) EXPECT_EQ(use.share, 0) << use.name;
}

}  // namespace verdict_test
