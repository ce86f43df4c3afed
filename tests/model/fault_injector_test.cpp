// Each kind of fault does what its name says, on a small chip.

#include "model/faults/fault_injector.hpp"

#include <cstring>

#include "tests/support/control_bench.hpp"
#include "tests/support/hazards.hpp"

namespace fault_injector_test {

using cn::InstructionClass;
using cn::LaneMask;
using cn::Machine;
using cn::Semaphore;
using model::Cycles;
using model::Fault;
using model::FaultKind;
using test_support::expect_parts;
using test_support::fault_of;
using test_support::issues;
using test_support::kFake;
using test_support::test_chip;

/// A kernel that adds 1 to the first word of every enabled PE.
struct NoArguments {};

void run_increment(const NoArguments&, cn::PolyMemory& poly, const LaneMask& enabled, cn::IssueTree& issued) {
  issued.clear();
  issued.root().counts[InstructionClass::int64_alu] = 10;
  issued.root().enabled_lanes = std::uint64_t(enabled.count());
  issued.root().reached = enabled.any();
  for (int pe = 0; pe < poly.num_pes(); ++pe)
    if (enabled[pe]) ++poly.word(pe, 0);
}

constexpr cn::Kernel<NoArguments> kIncrement{"increment", &run_increment};

class FaultInjector : public test_support::ControlBench {
 protected:
  void inject(std::vector<Fault> faults, bool ecc = true) {
    model::ChipConfig config = test_chip();
    config.ddr.ecc = ecc;
    build(config);
    chip->inject(std::move(faults));
  }
  std::string failure() {
    return fault_of([this] { chip->control_unit.require_finished(); });
  }
  std::uint64_t word(int pe, int offset = 0) { return chip->control_unit.poly_memory().word(pe, offset); }
  void set_mono(std::uint64_t address, std::uint64_t value) {
    std::memcpy(mono() + address, &value, sizeof(value));
  }
  std::uint64_t mono_word(std::uint64_t address) {
    std::uint64_t value = 0;
    std::memcpy(&value, mono() + address, sizeof(value));
    return value;
  }
};

TEST_F(FaultInjector, FlipsABitOfOnePesSramFromItsCycleOn) {
  inject({{FaultKind::poly_sram, 50, 3, 17, 2}});
  std::uint64_t before = 1;
  run_well([&](Machine& machine) {
    machine.run(kFake, issues(InstructionClass::int16_alu, 49), LaneMask::first(8));
    before = word(3, 16);
    machine.run(kFake, issues(InstructionClass::int16_alu, 1), LaneMask::first(8));
  });
  EXPECT_EQ(before, 0u);
  EXPECT_EQ(word(3, 16), std::uint64_t{1} << 10);  // bit 2 of the second byte
  for (const int pe : {0, 1, 2, 4, 5, 6, 7}) EXPECT_EQ(word(pe, 16), 0u) << pe;
  EXPECT_EQ(chip->fault_counts().injected, 1u);
}

TEST_F(FaultInjector, FlipsWhatTheKernelInProgressStores) {
  inject({{FaultKind::poly_register, 15, 2, 0, 40}});
  run_well([&](Machine& machine) {
    for (int i = 0; i < 3; ++i) machine.run(kIncrement, {}, LaneMask::first(8));
  });
  EXPECT_EQ(word(1), 3u);
  EXPECT_EQ(word(2), (std::uint64_t{1} << 40) + 3);
}

TEST_F(FaultInjector, LeavesARegisterAloneThatNoKernelStores) {
  inject({{FaultKind::poly_register, 5, 7, 0, 40}});
  run_well([&](Machine& machine) { machine.run(kIncrement, {}, LaneMask::first(4)); });
  EXPECT_EQ(word(7), 0u);
  EXPECT_EQ(chip->fault_counts().injected, 1u);
}

TEST_F(FaultInjector, KeepsAPeFromStoringAndFromTransfers) {
  inject({{FaultKind::enable_off, 15, 2}});
  run_well([&](Machine& machine) {
    for (int i = 0; i < 3; ++i) machine.run(kIncrement, {}, LaneMask::first(8));
    const Semaphore done = machine.allocate_semaphore("done");
    save(machine, done);
    machine.sem_wait(done);
  });
  EXPECT_EQ(word(1), 3u);
  EXPECT_EQ(word(2), 2u);  // the second kernel was in progress
  EXPECT_EQ(mono_word(4096 + 32), 3u);
  EXPECT_EQ(mono_word(4096 + 64), 0u);
  EXPECT_EQ(chip->pio_engine.statistics().pes, 7u);
}

TEST_F(FaultInjector, FlipsABitOfTheDdr) {
  inject({{FaultKind::ddr, 10, 0, 33, 7}}, false);
  run_well([&](Machine& machine) {
    machine.issue_mono(20);
    const Semaphore done = machine.allocate_semaphore("done");
    load(machine, done);
    machine.sem_wait(done);
  });
  EXPECT_EQ(word(1), std::uint64_t{1} << 15);
  EXPECT_EQ(word(0), 0u);
}

TEST_F(FaultInjector, EccCorrectsOneBitAndCountsIt) {
  inject({{FaultKind::ddr, 10, 0, 33, 7}});
  run_well([&](Machine& machine) {
    machine.issue_mono(20);
    const Semaphore done = machine.allocate_semaphore("done");
    for (int i = 0; i < 2; ++i) {
      load(machine, done);
      machine.sem_wait(done);
    }
  });
  EXPECT_EQ(word(1), 0u);
  EXPECT_EQ(chip->fault_counts().corrected, 1u);  // the first read repaired it
}

TEST_F(FaultInjector, AWriteOfTheWordReplacesWhatIsWrong) {
  inject({{FaultKind::ddr_double, 10, 0, 4096, 0}});
  run_well([&](Machine& machine) {
    machine.issue_mono(20);
    const Semaphore done = machine.allocate_semaphore("done");
    save(machine, done);
    machine.sem_wait(done);
    machine.read_mono(cn::MonoPointer<std::uint64_t>{4096});
    machine.issue_mono(1);
  });
  EXPECT_EQ(chip->fault_counts().corrected, 0u);
  EXPECT_EQ(chip->fault_counts().detected, 0u);
}

TEST_F(FaultInjector, EccDetectsTwoBits) {
  inject({{FaultKind::ddr_double, 10, 0, 33, 0}});
  run([&](Machine& machine) {
    machine.issue_mono(20);
    const Semaphore done = machine.allocate_semaphore("done");
    load(machine, done);
    machine.sem_wait(done);
  });
  EXPECT_EQ(failure(),
            "ECC: the word of the DDR at mono address 32 has more wrong bits than can be corrected");
  EXPECT_EQ(chip->fault_counts().detected, 1u);
}

TEST_F(FaultInjector, TwoFlipsOfOneWordAreTwoWrongBits) {
  inject({{FaultKind::ddr, 10, 0, 32, 0}, {FaultKind::ddr, 11, 0, 39, 7}});
  run([&](Machine& machine) {
    machine.issue_mono(20);
    machine.read_mono(cn::MonoPointer<std::uint64_t>{32});
    machine.issue_mono(1);
  });
  expect_parts(failure(), {"ECC", "mono address 32"});
}

TEST_F(FaultInjector, ALostSignalLeavesItsWaiterAndTheReportNamesIt) {
  inject({{FaultKind::pio_lost, 0}});
  run([](Machine& machine) {
    const Semaphore done = machine.allocate_semaphore("load buffer 1");
    load(machine, done);
    machine.sem_wait(done);
  });
  expect_parts(failure(), {"deadlock", "the control unit waits for semaphore 'load buffer 1'"});
}

/// The firmware's cycles with one fault.
class SignalFault : public FaultInjector {
 protected:
  Cycles cycles(std::vector<Fault> faults) {
    new_context();
    inject(std::move(faults));
    run_well([](Machine& machine) {
      const Semaphore done = machine.allocate_semaphore("done");
      for (int i = 0; i < 3; ++i) {
        load(machine, done);
        machine.run(kFake, issues(InstructionClass::int16_alu, 60), LaneMask::first(8));
        machine.sem_wait(done);
      }
    });
    return chip->control_unit.now() - test_support::kStart;
  }
};

TEST_F(SignalFault, ALateSignalCostsWhatItIsLate) {
  const Cycles in_time = cycles({});
  EXPECT_EQ(cycles({{FaultKind::pio_late, 0, 0, 0, 0, 77}}), in_time + 77);
}

TEST_F(SignalFault, ADoubledSignalLetsALaterWaitPassTooSoon) {
  const Cycles in_time = cycles({});
  // The second wait finds the signal that is one too many, the third one that of the second request.
  const Cycles doubled = cycles({{FaultKind::pio_doubled, 0}});
  EXPECT_LT(doubled, in_time - kRequestCycles / 2);
}

TEST_F(FaultInjector, TheWatchdogEndsFirmwareThatRunsForEver) {
  model::ChipConfig config = test_chip();
  config.chip.watchdog_cycles = 5000;
  build(config);
  run([](Machine& machine) {
    for (;;) machine.issue_mono(100);
  });
  EXPECT_EQ(failure(), "watchdog: the firmware has run for more than 5000 cycles (chip.watchdog_cycles)");
}

TEST_F(FaultInjector, TheWatchdogLeavesFirmwareAloneThatEndsInTime) {
  model::ChipConfig config = test_chip();
  config.chip.watchdog_cycles = 5000;
  build(config);
  run_well([](Machine& machine) { machine.issue_mono(5000); });
}

}  // namespace fault_injector_test
