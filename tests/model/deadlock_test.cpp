// A chip that is deadlocked says who waits for whom.

#include <string>

#include "tests/support/control_bench.hpp"
#include "tests/support/hazards.hpp"

namespace deadlock_test {

using cn::LaneMask;
using cn::Machine;
using cn::Semaphore;
using model::TimingStyle;
using test_support::expect_parts;
using test_support::fault_of;
using test_support::kFake;
using test_support::kStart;
using test_support::test_chip;

constexpr Semaphore kToHost{0};
constexpr Semaphore kFromHost{1};

class Deadlock : public test_support::ControlBench, public testing::WithParamInterface<TimingStyle> {
 protected:
  Deadlock() { build(test_chip(), GetParam()); }

  std::string report() {
    return fault_of([this] { chip->control_unit.require_finished(); });
  }
  std::string first_line() { return report().substr(0, report().find('\n')); }

  static void allocate_host_semaphores(Machine& machine) {
    machine.allocate_semaphore("to host");
    machine.allocate_semaphore("from host");
  }
};

TEST_P(Deadlock, OfASemaphoreThatNobodySignals) {
  run([](Machine& machine) {
    machine.issue_mono(20);
    machine.sem_wait(machine.allocate_semaphore("forgotten"));
  });
  EXPECT_EQ(report(),
            "deadlock at cycle 1021: the control unit waits for semaphore 'forgotten', which no outstanding "
            "transfer "
            "will signal\n"
            "  the control unit waits since cycle 1021 for semaphore 0 'forgotten', count 0; nobody is left "
            "who could "
            "signal it; never signalled, no transfer was started on it; no kernel has run");
}

TEST_P(Deadlock, OfOneWaitTooManyNamesTheLastTransferAndKernel) {
  run([](Machine& machine) {
    const Semaphore done = machine.allocate_semaphore("save buffer 3");
    const Semaphore other = machine.allocate_semaphore("load buffer 1");
    load(machine, other);
    save(machine, done);
    machine.run(kFake, test_support::issues(test_support::InstructionClass::fp64_add, 30),
                LaneMask::first(8));
    machine.sem_wait(done);
    machine.sem_wait(done);
  });
  expect_parts(first_line(), {"deadlock at cycle ", "'save buffer 3'"});
  expect_parts(
      report(),
      {"last signalled by a PIO request at cycle 14", "1 transfer was started on it, the last a save",
       "last kernel 'fake', ended at cycle 1030", "signals that nobody has taken: 1 of 'load buffer 1'"});
}

/// Takes what the firmware signals; answers as often as it is told to.
class Host : public sc_core::sc_module {
 public:
  Host(const sc_core::sc_module_name& name, model::Csx600& chip, int answers)
      : sc_module(name), chip_(chip), answers_(answers) {
    chip_.control_unit.host_semaphores().share(kToHost);
    chip_.control_unit.host_semaphores().share(kFromHost);
    SC_HAS_PROCESS(Host);
    SC_THREAD(run);
  }

 private:
  void run() {
    while (true) {
      while (chip_.control_unit.host_semaphores().try_wait(kToHost)) {
        if (answers_-- <= 0) return;
        wait(100, sc_core::SC_NS);
        chip_.control_unit.host_semaphores().signal(kFromHost);
      }
      wait(chip_.control_unit.host_semaphores().firmware_signalled());
    }
  }
  model::Csx600& chip_;
  int answers_;
};

TEST_P(Deadlock, OfHostAndFirmwareThatWaitForEachOther) {
  Host host("host", *chip, 1);
  run([](Machine& machine) {
    allocate_host_semaphores(machine);
    machine.issue_mono(10);
    machine.sem_signal(kToHost);
    machine.sem_wait(kFromHost);
    machine.sem_wait(kFromHost);
  });
  EXPECT_EQ(first_line(),
            "deadlock at cycle 1112: the control unit waits for semaphore 'from host', the host waits for "
            "semaphore 'to "
            "host', which no outstanding transfer will signal");
  expect_parts(report(), {"the control unit waits since cycle 1112 for semaphore 1 'from host', count 0; the "
                          "host could signal it, "
                          "but waits itself; last signalled by the host at cycle 1111",
                          "the host waits since cycle 1111 for semaphore 0 'to host', count 0; the control "
                          "unit could signal it, but "
                          "waits itself; last signalled by the control unit at cycle 1011"});
}

TEST_P(Deadlock, OfAHostThatNeverAnswers) {
  Host host("host", *chip, 0);
  run([](Machine& machine) {
    allocate_host_semaphores(machine);
    machine.sem_signal(kToHost);
    machine.sem_wait(kFromHost);
  });
  expect_parts(first_line(),
               {"deadlock at cycle 1002: the control unit waits for semaphore 'from host', which"});
  expect_parts(report(), {"the host could signal it, but does nothing any more; never signalled",
                          "the host waits for no semaphore; it took one of 'to host' at cycle 1001"});
}

TEST_P(Deadlock, OfAHostThatNeverLooks) {
  chip->control_unit.host_semaphores().share(kFromHost);
  run([](Machine& machine) {
    allocate_host_semaphores(machine);
    const Semaphore done = machine.allocate_semaphore("done");
    load(machine, done);
    machine.sem_wait(kFromHost);
  });
  expect_parts(report(), {"'from host'", "the host waits for no semaphore", "1 of 'done'"});
}

TEST_P(Deadlock, IsNoneOfAFirmwareThatEnds) {
  run([](Machine& machine) { machine.issue_mono(1); });
  EXPECT_EQ(report(), "");
}

TEST_P(Deadlock, OfAFirmwareThatIsNeverStarted) {
  chip->control_unit.load([](Machine&) {});
  sc_core::sc_start();
  EXPECT_EQ(report(), "the firmware was not started: SystemC has nothing left to do");
}

INSTANTIATE_TEST_SUITE_P(Timing, Deadlock,
                         testing::Values(TimingStyle::loosely_timed, TimingStyle::approximately_timed),
                         [](const auto& style) {
                           return style.param == TimingStyle::loosely_timed ? "Loose" : "Approximate";
                         });

}  // namespace deadlock_test
