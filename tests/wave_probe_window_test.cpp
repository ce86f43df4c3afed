// The file of a WaveProbe: its window, its ends, and what can go wrong with it.

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "tests/support/wave_probe_fixture.hpp"

namespace {

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
    EXPECT_GT(std::filesystem::file_size(file()), 1000u) << "the file is complete once the window is over";
  });
  probe->finish();
  const VcdReader vcd(file());
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
  const VcdReader vcd(file());
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
  const VcdReader vcd(file());
  EXPECT_EQ(vcd.first_time(), 50'000u);
  EXPECT_EQ(vcd.last_time(), 80'000u);
  EXPECT_EQ(vcd.time_at_value("control.state", state(CycleCause::mono)), 30'000u);
}

TEST_F(WaveProbeWindow, NothingIsPrinted) {
  make_probe();
  const auto handler_of_tests = sc_core::sc_report_handler::set_handler(nullptr);  // the one of real runs
  testing::internal::CaptureStdout();
  simulate([&](Reporter& reporter) {
    probe->spent(CycleCause::mono, 0, 80, -1);
    reporter.wait_until(80);
  });
  probe->finish();
  const std::string printed = testing::internal::GetCapturedStdout();
  sc_core::sc_report_handler::set_handler(handler_of_tests);
  EXPECT_EQ(printed, "");
}

TEST_F(WaveProbeWindow, NamedPipeCarriesTheWholeFile) {
  const std::string copy = (directory / "copy.vcd").string();
  ASSERT_EQ(std::system(("mkfifo " + file() + " && cat " + file() + " > " + copy + " &").c_str()), 0);
  while (!std::filesystem::is_fifo(file())) usleep(1000);
  make_probe();
  simulate([&](Reporter& reporter) {
    probe->spent(CycleCause::mono, 0, 80, -1);
    reporter.wait_until(100);
  });
  probe->finish();
  std::string tail;
  for (int i = 0; i < 1000 && tail.find("#100000") == std::string::npos; ++i, usleep(1000)) {
    std::ostringstream text;
    text << std::ifstream(copy).rdbuf();
    tail = text.str();
  }
  EXPECT_EQ(VcdReader(copy).time_at_value("control.state", state(CycleCause::mono)), 80'000u);
}

TEST_F(WaveProbeWindow, FileThatCannotBeCreatedIsRefusedBeforeTheRun) {
  const auto make = [&](const std::string& name) {
    return [this, name] {
      model::WaveProbe("probe", model::WaveConfig{name}, clock, [] { return model::MemoryCounters{}; });
    };
  };
  expect_message(make((directory / "missing" / "a.vcd").string()), "No such file or directory");
  std::filesystem::create_directory(directory / "taken.vcd");
  expect_message(make((directory / "taken.vcd").string()), "Is a directory");
  expect_message(make((directory / "a.fst").string()), "ends in .vcd");
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

TEST_F(WaveProbeWindow, FullDiskIsReported) {
  // SystemC does not look at the result of its writes; a file cut short must be noticed all the same.
  make_probe(0, 50);
  simulate([&](Reporter& reporter) {
    probe->spent(CycleCause::mono, 0, 80, -1);
    reporter.wait_until(80);
    std::filesystem::resize_file(file(), 1024);
  });
  expect_message([&] { probe->finish(); }, "not complete");
}

}  // namespace
