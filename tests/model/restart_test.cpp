// Firmware that is started again on the same chip.

#include <stdexcept>

#include "tests/support/control_bench.hpp"

namespace restart_test {

using model::Cycles;
using model::TimingStyle;
using test_support::ControlBench;

class Restart : public ControlBench, public testing::WithParamInterface<TimingStyle> {
 protected:
  void SetUp() override {
    build(test_support::test_chip(), GetParam());
    elaborate();
  }
  static void run_to_the_end() {
    sc_core::sc_start(sc_core::sc_time(1, sc_core::SC_SEC), sc_core::SC_EXIT_ON_STARVATION);
  }
  /// Returns the cycles of the run.
  Cycles start_well() {
    chip->control_unit.start();
    run_to_the_end();
    chip->control_unit.require_finished();
    EXPECT_EQ(statistics().total(), chip->control_unit.now() - chip->control_unit.start_cycle());
    return statistics().total();
  }
  /// Fills most of a PE's SRAM, allocates a semaphore and adds 1 to a word of mono memory by way of PE 0.
  static void count_up(cn::Machine& machine) {
    const cn::PolySpan span = machine.poly_memory().allocate("count", 600);
    const cn::Semaphore done = machine.allocate_semaphore("done");
    const cn::PolySpan word{span.offset_bytes, 8};
    machine.async_copy_m2p(done, word, cn::MonoPlaces::array(64, 8), cn::LaneMask::first(1));
    machine.sem_wait(done);
    ++machine.poly_memory().word(0, span.offset_bytes);
    machine.run(test_support::kFake, test_support::issues(cn::InstructionClass::int16_alu, 100),
                cn::LaneMask::first(8));
    machine.async_copy_p2m(done, cn::MonoPlaces::array(64, 8), word, cn::LaneMask::first(1));
    machine.sem_wait(done);
  }
};

TEST_P(Restart, EachRunBeginsAnewAndFindsWhatIsInMemory) {
  chip->control_unit.load(&count_up);
  std::vector<Cycles> cycles;
  for (int run = 0; run < 100; ++run) cycles.push_back(start_well());  // more than there are semaphores
  EXPECT_EQ(mono()[64], 100);
  for (std::size_t run = 2; run < cycles.size(); ++run) EXPECT_EQ(cycles[run], cycles[1]);  // the row is open
  EXPECT_EQ(spent(model::CycleCause::poly), 100u);
  EXPECT_EQ(chip->pio_engine.statistics().requests_to_poly, 100u);
}

TEST_P(Restart, AnotherFirmwareCanBeLoaded) {
  chip->control_unit.load(&count_up);
  const Cycles first = start_well();
  chip->control_unit.load([](cn::Machine& machine) { machine.issue_mono(37); });
  EXPECT_EQ(start_well(), 37u);
  EXPECT_GE(chip->control_unit.start_cycle(), first);
}

TEST_P(Restart, SignalsThatNobodyTookAreNotThereTheNextTime) {
  chip->control_unit.load([](cn::Machine& machine) { load(machine, machine.allocate_semaphore("done")); });
  start_well();
  chip->control_unit.load([](cn::Machine& machine) {
    machine.issue_mono(1000);
    machine.sem_wait(machine.allocate_semaphore("other"));
  });
  chip->control_unit.start();
  run_to_the_end();
  EXPECT_THROW(chip->control_unit.require_finished(), cn::MachineFault);
}

TEST_P(Restart, IsRefusedWhileTheFirmwareRuns) {
  chip->control_unit.load([this](cn::Machine& machine) {
    machine.issue_mono(1);
    EXPECT_THROW(chip->control_unit.start(), std::logic_error);
  });
  chip->control_unit.start();
  EXPECT_THROW(chip->control_unit.start(), std::logic_error);
  run_to_the_end();
  chip->control_unit.require_finished();
}

TEST_P(Restart, IsRefusedAfterAFault) {
  chip->control_unit.load([](cn::Machine&) { throw cn::MachineFault("wrong"); });
  chip->control_unit.start();
  run_to_the_end();
  EXPECT_THROW(chip->control_unit.require_finished(), cn::MachineFault);
  EXPECT_THROW(chip->control_unit.start(), std::logic_error);
}

INSTANTIATE_TEST_SUITE_P(Styles, Restart,
                         testing::Values(TimingStyle::loosely_timed, TimingStyle::approximately_timed),
                         [](const testing::TestParamInfo<TimingStyle>& style) {
                           return style.param == TimingStyle::loosely_timed ? "Lt" : "At";
                         });

TEST_F(ControlBench, ThreadsRunAgain) {
  build(test_support::test_chip());
  elaborate();
  int ran = 0;
  chip->control_unit.load([&](cn::Machine& machine) {
    const cn::Semaphore done = machine.allocate_semaphore("done");
    machine.start_thread(cn::kFirstThreadPriority + 1, "helper", [&machine, &ran, done] {
      ++ran;
      machine.sem_signal(done);
    });
    machine.sem_wait(done);
  });
  for (int run = 0; run < 10; ++run) {
    chip->control_unit.start();
    sc_core::sc_start(sc_core::sc_time(1, sc_core::SC_MS), sc_core::SC_EXIT_ON_STARVATION);
    chip->control_unit.require_finished();
  }
  EXPECT_EQ(ran, 10);
}

}  // namespace restart_test
