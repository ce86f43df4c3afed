// Faults as text, the classes of runs and the campaign's table.

#include "testbench/faults/fault_text.hpp"

#include <gtest/gtest.h>

#include "testbench/faults/fault_campaign.hpp"
#include "testbench/faults/fault_outcome.hpp"
#include "testbench/faults/fault_table.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/temporary_directory.hpp"

namespace fault_text_test {

using testbench::compare_with;
using testbench::fault_csv;
using testbench::fault_of;
using testbench::fault_rows;
using testbench::FaultOutcome;
using testbench::FaultResult;
using testbench::FaultRow;
using testbench::FaultStore;
using testbench::Film;
using testbench::InputError;
using testbench::RenderResult;
using testbench::stopped_by;
using testbench::text_of;
using testbench::wilson_interval;

RenderResult result_of(double red) {
  RenderResult result(Film({2, 1}, 1.0));
  result.film.add(0, {0.5, 0.5, 0.5});
  result.film.add(1, {red, 0.5, 0.5});
  return result;
}

TEST(FaultText, IsReadAsItIsWritten) {
  for (const model::FaultKindInfo& kind : model::kFaultKinds) {
    model::Fault fault{kind.kind, 1000};
    if (kind.has_pe) fault.pe = 5;
    if (kind.has_address) fault.address = 0x40;
    if (kind.bits > 0) fault.bit = kind.bits - 1;
    if (kind.has_late_cycles) fault.late_cycles = 9;
    const std::string text = text_of(fault);
    const model::Fault read = fault_of(text);
    EXPECT_EQ(read.kind, kind.kind);
    EXPECT_EQ(text_of(read), text);
  }
  EXPECT_EQ(fault_of("poly_sram,bit=3,address=0x40,pe=5,cycle=7").address, 64u);
}

TEST(FaultText, KindsStandInTheTableWhereTheirNumbersSay) {
  for (const model::FaultKindInfo& kind : model::kFaultKinds) EXPECT_EQ(&info_of(kind.kind), &kind);
}

TEST(FaultOutcome, TellsClassesApartByTheImage) {
  const std::vector<double> fault_free = result_of(0.25).film.rgb();
  EXPECT_EQ(compare_with(fault_free, result_of(0.25)).outcome, FaultOutcome::masked);
  const FaultResult slight = compare_with(fault_free, result_of(0.25 + 1e-9));
  EXPECT_EQ(slight.outcome, FaultOutcome::slightly_wrong);
  EXPECT_EQ(slight.differing_pixels, 1);
  const FaultResult wrong = compare_with(fault_free, result_of(0.5));
  EXPECT_EQ(wrong.outcome, FaultOutcome::wrong_pixels);
  EXPECT_EQ(wrong.largest_difference, 188 - 137);  // sRGB codes of 0.5 and 0.25, IEC 61966-2-1
  RenderResult corrected = result_of(0.25);
  corrected.faults.corrected = 1;
  EXPECT_EQ(compare_with(fault_free, corrected).outcome, FaultOutcome::corrected);
}

TEST(FaultOutcome, TellsClassesApartByTheMessage) {
  EXPECT_EQ(stopped_by("ECC: the word of the DDR").outcome, FaultOutcome::detected);
  EXPECT_EQ(stopped_by("watchdog: the firmware").outcome, FaultOutcome::hang);
  EXPECT_EQ(stopped_by("deadlock at cycle 7: a waits").outcome, FaultOutcome::hang);
  EXPECT_EQ(stopped_by("--time-limit: the run has not ended after 3 s").outcome, FaultOutcome::hang);
  EXPECT_EQ(stopped_by("a run ended without a result (signal or crash)").outcome, FaultOutcome::crashed);
  EXPECT_EQ(stopped_by("PIO request 232: PE 9 addresses 80 bytes at 0x1").outcome, FaultOutcome::stopped);
}

TEST(FaultTable, IntervalsAreWilsons) {
  // Of 10 in 100: centre (0.1 + 1.9207 / 100) / 1.038415 = 0.114796, half 0.059567 (Wilson 1927, eq. 5).
  const auto [low, high] = wilson_interval(10, 100);
  EXPECT_NEAR(low, 0.05523, 1e-5);
  EXPECT_NEAR(high, 0.17437, 1e-5);
  EXPECT_NEAR(wilson_interval(0, 50).first, 0, 1e-15);
  EXPECT_NEAR(wilson_interval(50, 50).second, 1, 1e-15);
  EXPECT_EQ(wilson_interval(0, 0), std::make_pair(0.0, 1.0));
}

TEST(FaultStore, KeepsWholeLinesOfTheSameCampaignOnly) {
  const test_support::TemporaryDirectory directory;
  const FaultStore::Json campaign = {{"seed", 1}};
  const std::string line =
      R"({"number":4,"kind":"ddr","fault":"ddr","outcome":"wrong_pixels","differing_pixels":2,)"
      R"("largest_difference":9,"extra_cycles":-3,"message":""})";
  FaultStore(directory.path(), campaign).add(line);
  {
    std::ofstream file(directory.path() / "faults.jsonl", std::ios::app);
    file << line.substr(0, 30);
  }
  const FaultStore again(directory.path(), campaign);
  EXPECT_EQ(again.runs().size(), 1u);
  EXPECT_TRUE(again.has(4));
  const std::vector<FaultRow> rows = fault_rows(again);
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].vulnerable(), 1);
  EXPECT_NE(fault_csv(rows).find("ddr,1,0,0,0,1,0,0,0,0,1,"), std::string::npos) << fault_csv(rows);
  EXPECT_THROW(FaultStore(directory.path(), {{"seed", 2}}), InputError);
}

}  // namespace fault_text_test
