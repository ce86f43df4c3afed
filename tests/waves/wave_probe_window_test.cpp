// The file of a WaveProbe: its window, its ends, and what can go wrong with it.

#include <algorithm>

#include "tests/support/wave_probe_fixture.hpp"

namespace wave_probe_window_test {

using model::CycleCause;
using model::Cycles;
using test_support::changes;
using test_support::Reporter;
using test_support::state;
using test_support::VcdReader;
using List = test_support::ChangeList;

class WaveProbeWindow : public test_support::WaveProbeFixture {};

void expect_message(const std::function<void()>& action, const std::string& part) {
  try {
    action();
    ADD_FAILURE() << "no WaveError";
  } catch (const model::WaveError& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find(part), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

TEST_F(WaveProbeWindow, WindowCutsWithoutLosingWhatHoldsAtItsEnds) {
  make_probe(100, 200);
  simulate([&](Reporter& reporter) {
    probe->spent(CycleCause::mono, 0, 50, -1);
    load(0, 40, 120);
    probe->ran_kernel("before", 50, 60, 96);
    probe->spent(CycleCause::poly, 50, 150, -1);
    probe->ran_kernel("across", 60, 150, 64);
    reporter.wait_until(150);
    probe->spent(CycleCause::wait_load, 150, 199, 2);
    probe->spent(CycleCause::mono, 199, 200, -1);  // in the window's last cycle
    save(1, 190, 260);
    probe->spent(CycleCause::poly, 200, 300, -1);
    probe->ran_kernel("after", 200, 300, 64);
    reporter.wait_until(300);
  });
  probe->finish();
  const VcdReader vcd = this->vcd();
  EXPECT_EQ(vcd.first_time(), 100'000u);
  EXPECT_EQ(vcd.last_time(), 200'000u);
  EXPECT_EQ(changes(vcd, "control.state"), (List{{100'000, state(CycleCause::poly)},
                                                 {150'000, state(CycleCause::wait_load)},
                                                 {199'000, state(CycleCause::mono)}}));
  EXPECT_EQ(changes(vcd, "control.kernel"), (List{{100'000, 2}, {150'000, 0}}));
  EXPECT_EQ(changes(vcd, "pio.loading"), (List{{100'000, 1}, {120'000, 0}}));
  EXPECT_EQ(changes(vcd, "pio.saving"), (List{{100'000, 0}, {190'000, 1}}));
  EXPECT_EQ(vcd.time_at_value("pio.loading", 1), 20'000u);
  EXPECT_EQ(vcd.time_at_value("pio.saving", 1), 10'000u);
  EXPECT_EQ(probe->kernel_names().size(), 3u) << "kernels are numbered alike in every window";
  EXPECT_EQ(probe->window_start(), clock.time_at(100));
  EXPECT_EQ(probe->window_end(), clock.time_at(200));
}

TEST_F(WaveProbeWindow, OneStateThroughoutTheWindowIsStillRecorded) {
  make_probe(1000, 2000);
  simulate([&](Reporter& reporter) {
    probe->spent(CycleCause::poly, 0, 5000, -1);
    reporter.wait_until(5000);
  });
  probe->finish();
  const VcdReader vcd = this->vcd();
  EXPECT_EQ(vcd.time_at_value("control.state", state(CycleCause::poly)), 1'000'000u);
}

TEST_F(WaveProbeWindow, WindowsEndsDoNotKeepASimulationRunning) {
  make_probe(50, 1'000'000);
  simulate([&](Reporter& reporter) {
    probe->spent(CycleCause::mono, 0, 80, -1);
    reporter.wait_until(80);
  });
  EXPECT_EQ(sc_core::sc_time_stamp(), clock.time_at(80));
  probe->finish();
  const VcdReader vcd = this->vcd();
  EXPECT_EQ(vcd.first_time(), 50'000u);
  EXPECT_EQ(vcd.last_time(), 80'000u);
  EXPECT_EQ(vcd.time_at_value("control.state", state(CycleCause::mono)), 30'000u);
}

TEST_F(WaveProbeWindow, SeveralWindowsLeaveGapsOfTheUnknown) {
  model::WaveConfig config;
  config.windows = {{20, 30}, {60, 80}, {70, 90}};  // the last two overlap
  make_probe(config);
  simulate([&](Reporter& reporter) {
    for (Cycles cycle = 0; cycle < 200; cycle += 10) {
      probe->spent(CycleCause::mono, cycle, cycle + 5, -1);
      probe->spent(CycleCause::poly, cycle + 5, cycle + 10, -1);
    }
    reporter.wait_until(200);
  });
  probe->finish();
  const VcdReader vcd = this->vcd();
  const std::uint64_t unknown = VcdReader::kUnknown;
  EXPECT_EQ(changes(vcd, "control.state"), (List{{20'000, state(CycleCause::mono)},
                                                 {25'000, state(CycleCause::poly)},
                                                 {30'000, unknown},
                                                 {60'000, state(CycleCause::mono)},
                                                 {65'000, state(CycleCause::poly)},
                                                 {70'000, state(CycleCause::mono)},
                                                 {75'000, state(CycleCause::poly)},
                                                 {80'000, state(CycleCause::mono)},
                                                 {85'000, state(CycleCause::poly)}}));
  EXPECT_EQ(vcd.last_time(), 90'000u);
  EXPECT_EQ(vcd.time_at_value("control.state", state(CycleCause::mono)), 20'000u);
}

TEST_F(WaveProbeWindow, WindowsOfBlocksBeginWithTheirKernels) {
  model::WaveConfig config;
  config.blocks = {{2, 1}, {4, model::BlockWindow{}.count}};
  make_probe(config);
  simulate([&](Reporter& reporter) {
    for (int block = 0; block < 5; ++block) {
      const Cycles start = 100 * Cycles(block) + 10;
      probe->kernel_details({nullptr, nullptr, {"stage", block}});
      probe->ran_kernel("first", start, start + 20, 8);
      probe->kernel_details({nullptr, nullptr, {"stage", block}});
      probe->ran_kernel("second", start + 20, start + 50, 8);
      if (block % 2 == 1) reporter.wait_until(start + 50);
    }
    reporter.wait_until(500);
  });
  probe->finish();
  const VcdReader vcd = this->vcd();
  EXPECT_EQ(vcd.first_time(), 110'000u);
  EXPECT_EQ(vcd.last_time(), 500'000u);
  EXPECT_EQ(changes(vcd, "bins.compute_block"),
            (List{{110'000, 1}, {210'000, VcdReader::kUnknown}, {310'000, 3}, {410'000, 4}}));
}

TEST_F(WaveProbeWindow, BlockThatIsNeverReachedIsReported) {
  model::WaveConfig config;
  config.blocks = {{7, 1}};
  make_probe(config);
  simulate([&](Reporter& reporter) {
    probe->kernel_details({nullptr, nullptr, {"stage", 0}});
    probe->ran_kernel("kernel", 0, 20, 8);
    reporter.wait_until(20);
  });
  expect_message([&] { probe->finish(); }, "from block 7 on");
}

TEST_F(WaveProbeWindow, EmptySelectionsAreRefused) {
  const auto make = [&](const model::WaveSelection& selection) {
    return [this, selection] {
      model::WaveConfig config;
      config.selection = selection;
      model::check_waves(config, chip);
    };
  };
  expect_message(make({{"pio.*", "nothing"}, {}, {}}), "'nothing'");
  expect_message(make({{}, {}, std::vector<int>{8}}), "PE 8");
  expect_message(make({{"ddr.data"}, model::WaveLevel::overview, {}}), "no signal");
}

TEST_F(WaveProbeWindow, LevelsPatternsAndPesSelect) {
  const auto paths = [&](const model::WaveSelection& selection) {
    std::vector<std::string> list;
    for (const auto& signal : model::select_waves(chip, selection)) list.push_back(signal.path);
    return list;
  };
  using Paths = std::vector<std::string>;
  EXPECT_EQ(paths({{"pe_array.pe_*.enabled"}, {}, std::vector<int>{1, 7}}),
            (Paths{"pe_array.pe_1.enabled", "pe_array.pe_7.enabled"}));
  EXPECT_EQ(paths({{"pio.*ing"}, {}, {}}), (Paths{"pio.loading", "pio.saving"}));
  EXPECT_EQ(paths({{"ddr.*"}, model::WaveLevel::units, {}}), (Paths{"ddr.bus"}));
  const Paths units = paths({});
  for (const auto& signal : model::select_waves(chip, {}))
    EXPECT_LE(signal.info->level, model::WaveLevel::units);
  EXPECT_EQ(paths({{}, {}, std::vector<int>{3}}).size(), units.size() + 2) << "two signals a PE";
  EXPECT_LT(paths({{}, model::WaveLevel::overview, {}}).size(), units.size());
  EXPECT_EQ(paths({{}, model::WaveLevel::detail, {}}).size(), model::wave_instances(chip).size());
}

TEST_F(WaveProbeWindow, NumbersInNamesAreAsWideAsTheLast) {
  chip.chip.pes = 96;
  std::vector<std::string> paths;
  for (const auto& signal : model::wave_instances(chip))
    if (signal.info->id == model::WaveSignal::pe_enabled) paths.push_back(signal.path);
  ASSERT_EQ(paths.size(), 96u);
  EXPECT_EQ(paths.front(), "pe_array.pe_00.enabled");
  EXPECT_EQ(paths.back(), "pe_array.pe_95.enabled");
  EXPECT_TRUE(std::is_sorted(paths.begin(), paths.end()));
}

TEST_F(WaveProbeWindow, EmptyWindowIsRefused) {
  expect_message([&] { make_probe(200, 200); }, "from cycle 200 to before cycle 200");
}

TEST_F(WaveProbeWindow, WindowThatTheRunNeverReachesIsReported) {
  make_probe(1000, 2000);
  simulate([&](Reporter& reporter) {
    probe->spent(CycleCause::mono, 0, 80, -1);
    reporter.wait_until(80);
  });
  expect_message([&] { probe->finish(); }, "which ended at cycle 80");
}

TEST_F(WaveProbeWindow, RunThatEndsWhereTheWindowBeginsIsReported) {
  make_probe(80, 2000);
  simulate([&](Reporter& reporter) {
    probe->spent(CycleCause::mono, 0, 80, -1);
    load(0, 79, 81);
    reporter.wait_until(80);
    sc_core::sc_stop();
  });
  expect_message([&] { probe->finish(); }, "which ended at cycle 80");
}

}  // namespace wave_probe_window_test
