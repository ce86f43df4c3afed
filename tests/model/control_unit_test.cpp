#include "model/control/control_unit.hpp"

#include <string>
#include <vector>

#include "tests/support/control_bench.hpp"

namespace control_unit_test {

using cn::InstructionClass;
using cn::LaneMask;
using cn::Machine;
using cn::MonoPointer;
using cn::Semaphore;
using model::CycleCause;
using model::Cycles;
using test_support::FakeArguments;
using test_support::issues;
using test_support::kFake;
using test_support::kStart;
using test_support::test_chip;

class ControlUnit : public test_support::ControlBench {};

/// A cost table in which no two classes cost the same.
model::ChipConfig priced_chip() {
  model::ChipConfig config = test_chip();
  for (std::size_t i = 0; i < cn::kInstructionClasses; ++i) config.poly.cycles[i] = 100.0 + double(i);
  config.poly.cycles[std::size_t(InstructionClass::fp64_add)] = 4;
  config.poly.cycles[std::size_t(InstructionClass::fp64_mul)] = 5.5;
  config.poly.cycles[std::size_t(InstructionClass::sram)] = 1;
  config.poly.cycles[std::size_t(InstructionClass::mono)] = 2;
  return config;
}

FakeArguments ten_adds_three_products_six_words() {
  FakeArguments kernel;
  kernel.issued[InstructionClass::fp64_add] = 10;
  kernel.issued[InstructionClass::fp64_mul] = 3;
  kernel.issued[InstructionClass::sram] = 6;
  return kernel;
}

TEST_F(ControlUnit, KernelCostsItsInstructionsAtTheirPrices) {
  build(priced_chip());
  run_well(
      [](Machine& machine) { machine.run(kFake, ten_adds_three_products_six_words(), LaneMask::first(8)); });
  EXPECT_EQ(spent(CycleCause::poly), 63u);  // 10 x 4 + 3 x 5.5 + 6 x 1 = 62.5
  EXPECT_EQ(statistics().total(), 63u);
}

TEST_F(ControlUnit, KernelCostIsScaledByTheCodeQuality) {
  model::ChipConfig config = priced_chip();
  config.poly.code_quality_factor = 1.5;
  build(config);
  run_well(
      [](Machine& machine) { machine.run(kFake, ten_adds_three_products_six_words(), LaneMask::first(8)); });
  EXPECT_EQ(spent(CycleCause::poly), 94u);  // 93.75
}

TEST_F(ControlUnit, KernelCostDoesNotDependOnThePesEnabled) {
  build(priced_chip());
  run_well([](Machine& machine) {
    machine.run(kFake, issues(InstructionClass::fp64_add, 10), LaneMask::first(1));
    machine.run(kFake, issues(InstructionClass::fp64_add, 10), LaneMask());  // has no PE to run on
  });
  EXPECT_EQ(spent(CycleCause::poly), 40u);
}

TEST_F(ControlUnit, MonoInstructionsOfAKernelOverlapItsPolyInstructions) {
  build(priced_chip());
  run_well([](Machine& machine) {
    FakeArguments kernel = ten_adds_three_products_six_words();
    kernel.issued[InstructionClass::mono] = 31;  // 62 cycles, hidden
    machine.run(kFake, kernel, LaneMask::first(8));
    kernel.issued[InstructionClass::mono] = 50;  // 100 cycles, the longer stream
    machine.run(kFake, kernel, LaneMask::first(8));
  });
  EXPECT_EQ(spent(CycleCause::poly), 163u);
  EXPECT_EQ(spent(CycleCause::mono), 0u);
}

TEST_F(ControlUnit, MonoInstructionsOutsideKernelsTakeTimeOfTheirOwn) {
  build(priced_chip());
  run_well([](Machine& machine) { machine.issue_mono(7); });
  EXPECT_EQ(spent(CycleCause::mono), 14u);
  EXPECT_EQ(statistics().mono_instructions, 7u);
}

TEST_F(ControlUnit, MonoInstructionsAreScaledByTheCodeQualityToo) {
  model::ChipConfig config = priced_chip();
  config.poly.code_quality_factor = 1.5;
  build(config);
  run_well([](Machine& machine) { machine.issue_mono(7); });
  EXPECT_EQ(spent(CycleCause::mono), 21u);
}

// A line that is not in the cache: 6 cycles to the DDR, 30 to a page miss (20 to a hit), 4 for 32 bytes over
// the link, 6 back, and cache_miss_cycles = 25.
constexpr Cycles kPageMissLine = 6 + 30 + 4 + 6 + 25;
constexpr Cycles kPageHitLine = 6 + 20 + 4 + 6 + 25;

TEST_F(ControlUnit, MonoReadsFetchLinesOnce) {
  build(test_chip());
  for (int i = 0; i < 64; ++i) mono()[i] = std::uint8_t(i);
  run_well([](Machine& machine) {
    const auto* const bytes = machine.read_mono(MonoPointer<std::uint8_t>{0}, 32);
    EXPECT_EQ(bytes[31], 31);
    machine.read_mono(MonoPointer<std::uint8_t>{5}, 20);
    machine.read_mono(MonoPointer<std::uint8_t>{31});
    EXPECT_EQ(*machine.read_mono(MonoPointer<std::uint8_t>{32}), 32);
  });
  EXPECT_EQ(statistics().data_cache_hits, 2u);
  EXPECT_EQ(statistics().data_cache_misses, 2u);
  EXPECT_EQ(spent(CycleCause::data_cache), kPageMissLine + kPageHitLine);
  EXPECT_EQ(statistics().total(), kPageMissLine + kPageHitLine);
}

TEST_F(ControlUnit, MonoReadAcrossLinesFetchesEach) {
  build(test_chip());
  run_well([](Machine& machine) { machine.read_mono(MonoPointer<std::uint64_t>{24}, 6); });  // bytes 24 to 71
  EXPECT_EQ(statistics().data_cache_misses, 3u);
  EXPECT_EQ(spent(CycleCause::data_cache), kPageMissLine + 2 * kPageHitLine);
}

TEST_F(ControlUnit, MonoLinesOfOnePlaceInTheCacheDriveEachOtherOut) {
  build(test_chip());  // 4096 bytes
  run_well([](Machine& machine) {
    for (const cn::MonoAddress address : {0, 4096, 0, 32, 32})
      machine.read_mono(MonoPointer<double>{address});
  });
  EXPECT_EQ(statistics().data_cache_misses, 4u);
  EXPECT_EQ(statistics().data_cache_hits, 1u);
}

TEST_F(ControlUnit, MonoWriteWaitsForTheMemory) {
  build(test_chip());
  run_well([](Machine& machine) {
    machine.write_mono(MonoPointer<std::uint64_t>{512}, std::uint64_t{0x1122334455667788});
    EXPECT_EQ(*machine.read_mono(MonoPointer<std::uint64_t>{512}), 0x1122334455667788u);
  });
  EXPECT_EQ(mono()[512], 0x88);
  EXPECT_EQ(spent(CycleCause::mono), 1u);
  // 6 to the DDR, page miss 30, one cycle on its bus, 25; the read then hits the page after 4 of turn-round
  // at most.
  EXPECT_EQ(spent(CycleCause::data_cache), 6 + 30 + 1 + 25 + kPageHitLine);
}

TEST_F(ControlUnit, MonoAccessOutsideTheMemoryIsAFault) {
  build(test_chip());
  run([](Machine& machine) { machine.read_mono(MonoPointer<double>{(1 << 20) - 4}); });
  EXPECT_THROW(chip->control_unit.rethrow_failure(), cn::MachineFault);
}

TEST_F(ControlUnit, SignalsAndOpenWaitsCostTheSemaphoreInstruction) {
  model::ChipConfig config = test_chip();
  config.control.semaphore_cycles = 3;
  build(config);
  run_well([](Machine& machine) {
    const Semaphore semaphore = machine.allocate_semaphore("own");
    machine.sem_signal(semaphore);
    machine.sem_signal(semaphore);
    machine.sem_wait(semaphore);
    machine.sem_wait(semaphore);
  });
  EXPECT_EQ(spent(CycleCause::semaphore), 12u);
  EXPECT_EQ(statistics().total(), 12u);
}

TEST_F(ControlUnit, BlockedWaitsAreBookedByTheTransferTheyWaitFor) {
  run_well([this](Machine& machine) {
    const Semaphore loads = machine.allocate_semaphore("loads");
    const Semaphore saves = machine.allocate_semaphore("saves");
    load(machine, loads);
    machine.issue_mono(12);
    machine.sem_wait(loads);  // one cycle of its own
    EXPECT_EQ(spent(CycleCause::wait_load), kRequestCycles - 13);
    save(machine, saves);
    machine.sem_wait(saves);
    EXPECT_EQ(spent(CycleCause::wait_save), kRequestCycles - 1);
    load(machine, saves);  // the same semaphore for the other direction
    machine.sem_wait(saves);
    EXPECT_EQ(spent(CycleCause::wait_save), kRequestCycles - 1);
  });
  EXPECT_EQ(spent(CycleCause::wait_load), 2 * kRequestCycles - 13 - 1);
  EXPECT_EQ(statistics().exposed_pio(), 3 * kRequestCycles - 15);
  EXPECT_EQ(statistics().total(), 3 * kRequestCycles);
}

TEST_F(ControlUnit, TransfersHiddenByComputationAreNotWaitedFor) {
  run_well([](Machine& machine) {
    const Semaphore done = machine.allocate_semaphore("done");
    load(machine, done);
    machine.run(kFake, issues(InstructionClass::fp64_add, kRequestCycles), LaneMask::first(8));
    machine.sem_wait(done);
  });
  EXPECT_EQ(spent(CycleCause::wait_load), 0u);
  EXPECT_EQ(statistics().total(), kRequestCycles + 1);
}

TEST_F(ControlUnit, WaitsTakeOneSignalEach) {
  run_well([](Machine& machine) {
    const Semaphore done = machine.allocate_semaphore("done");
    load(machine, done);
    load(machine, done);
    machine.sem_wait(done);
    machine.sem_wait(done);
  });
  EXPECT_EQ(spent(CycleCause::wait_load), 2 * kRequestCycles - 2);
}

TEST_F(ControlUnit, EachCallOfACopyTakesItsCyclesBeforeTheEngineSeesIt) {
  model::ChipConfig config = test_chip();
  config.control.transfer_call_cycles = 37;
  build(config);
  run_well([this](Machine& machine) {
    const Semaphore done = machine.allocate_semaphore("done");
    load(machine, done);
    EXPECT_EQ(statistics().total(), 37u);
    machine.sem_wait(done);
    EXPECT_EQ(statistics().total(), 37u + kRequestCycles);
    save(machine, done);
    machine.sem_wait(done);
    load(machine, done, LaneMask());  // the software does not know that no PE wants anything
    machine.sem_wait(done);
  });
  EXPECT_EQ(spent(CycleCause::transfer_call), 3 * 37u);
  EXPECT_EQ(spent(CycleCause::wait_load), kRequestCycles - 1);
  EXPECT_EQ(spent(CycleCause::wait_save), kRequestCycles - 1);
  EXPECT_EQ(spent(CycleCause::mono), 0u);
}

TEST_F(ControlUnit, CallsOfCopiesOverlapWithTheCopiesBefore) {
  model::ChipConfig config = test_chip();
  config.control.transfer_call_cycles = 50;
  build(config);
  run_well([](Machine& machine) {
    const Semaphore done = machine.allocate_semaphore("done");
    load(machine, done);
    load(machine, done);  // called while the first is served
    machine.sem_wait(done);
    machine.sem_wait(done);
  });
  EXPECT_EQ(spent(CycleCause::transfer_call), 100u);
  EXPECT_EQ(statistics().total(), 50 + 2 * kRequestCycles);
}

TEST_F(ControlUnit, UntimedCopiesAreCalledForNothing) {
  model::ChipConfig config = test_chip();
  config.control.transfer_call_cycles = 37;
  build(config);
  run_well([](Machine& machine) {
    const Semaphore done = machine.allocate_semaphore("done");
    const cn::Untimed untimed(machine);
    load(machine, done);
    machine.sem_wait(done);
  });
  EXPECT_EQ(statistics().total(), 0u);
}

TEST_F(ControlUnit, TransferWithoutAPeIsOverAtOnce) {
  run_well([](Machine& machine) {
    const Semaphore done = machine.allocate_semaphore("done");
    load(machine, done, LaneMask());
    machine.sem_wait(done);
  });
  EXPECT_EQ(statistics().total(), 1u);
}

TEST_F(ControlUnit, FullQueueStopsTheControlUnit) {
  run_well([this](Machine& machine) {
    const Semaphore done = machine.allocate_semaphore("done");
    for (int i = 0; i < 3; ++i) load(machine, done);  // one in service, two in the queue
    EXPECT_EQ(spent(CycleCause::wait_pio_queue), 0u);
    machine.issue_mono(10);
    load(machine, done);  // until the second starts
    EXPECT_EQ(spent(CycleCause::wait_pio_queue), kRequestCycles - 10);
    for (int i = 0; i < 4; ++i) machine.sem_wait(done);
  });
  EXPECT_EQ(statistics().total(), 4 * kRequestCycles);
  EXPECT_EQ(spent(CycleCause::wait_load), 3 * kRequestCycles - 4);
}

TEST_F(ControlUnit, ProgrammedIoSlowsKernelsDownAtTheSramPorts) {
  run_well([this](Machine& machine) {
    const Semaphore done = machine.allocate_semaphore("done");
    load(machine, done);  // 32 words between cycles 100 and 212 of the request
    FakeArguments kernel = issues(InstructionClass::fp64_add, 300);
    kernel.issued[InstructionClass::sram] = 100;
    machine.run(kFake, kernel, LaneMask::first(8));  // 400 cycles, SRAM in a quarter of them
    EXPECT_EQ(spent(CycleCause::stolen), 8u);
    machine.sem_wait(done);
    load(machine, done);
    machine.run(kFake, issues(InstructionClass::sram, 156),
                LaneMask::first(8));  // half of the words pass by then
    EXPECT_EQ(spent(CycleCause::stolen), 8u + 16u);
    machine.sem_wait(done);
    machine.run(kFake, issues(InstructionClass::sram, 400), LaneMask::first(8));  // no word passes
  });
  EXPECT_EQ(spent(CycleCause::stolen), 24u);
  EXPECT_EQ(spent(CycleCause::poly), 400u + 156u + 400u);
}

TEST_F(ControlUnit, UntimedWorkIsDoneButCostsNothing) {
  build(test_chip());
  for (int i = 0; i < 256; ++i) mono()[i] = std::uint8_t(i);
  int services = 0;
  chip->control_unit.host_semaphores().on_untimed_signal([&] { ++services; });
  run_well([](Machine& machine) {
    const Semaphore done = machine.allocate_semaphore("done");
    const cn::Untimed untimed(machine);
    load(machine, done);
    machine.sem_wait(done);  // does not block
    save(machine, done);
    machine.run(kFake, issues(InstructionClass::fp64_add, 10), LaneMask::first(8));
    machine.issue_mono(100);
    EXPECT_EQ(*machine.read_mono(MonoPointer<std::uint8_t>{33}), 33);
    machine.write_mono(MonoPointer<std::uint8_t>{300}, std::uint8_t{7});
    machine.sem_signal(done);
  });
  EXPECT_EQ(statistics().total(), 0u);
  EXPECT_EQ(statistics().mono_instructions, 0u);
  EXPECT_EQ(statistics().data_cache_misses + statistics().data_cache_hits, 0u);
  EXPECT_EQ(chip->pe_array.total().runs, 0u);
  EXPECT_EQ(chip->pio_engine.statistics().busy_cycles(), 0u);
  EXPECT_EQ(mono()[4096 + 77], 77);  // through poly memory and back
  EXPECT_EQ(mono()[300], 7);
  EXPECT_EQ(services, 1);
}

TEST_F(ControlUnit, TimeGoesOnAfterUntimedWork) {
  run_well([](Machine& machine) {
    { const cn::Untimed untimed(machine); }
    machine.issue_mono(5);
  });
  EXPECT_EQ(statistics().total(), 5u);
}

TEST_F(ControlUnit, WaitThatNothingEndsIsADeadlockByName) {
  run([](Machine& machine) {
    machine.allocate_semaphore("another");
    const Semaphore forgotten = machine.allocate_semaphore("load buffer 3");
    machine.issue_mono(20);
    machine.sem_wait(forgotten);
  });
  try {
    chip->control_unit.rethrow_failure();
    FAIL() << "no fault";
  } catch (const cn::MachineFault& fault) {
    const std::string message = fault.what();
    for (const char* part : {"deadlock", "cycle 1021", "'load buffer 3'"})
      EXPECT_NE(message.find(part), std::string::npos) << message;
  }
}

TEST_F(ControlUnit, ExceptionsOfTheFirmwareReachTheCaller) {
  struct Odd {
    int value;
  };
  run([](Machine& machine) {
    machine.issue_mono(5);
    throw Odd{42};
  });
  EXPECT_TRUE(chip->control_unit.finished());
  try {
    chip->control_unit.rethrow_failure();
    FAIL() << "no exception";
  } catch (const Odd& odd) {
    EXPECT_EQ(odd.value, 42);
  }
}

TEST_F(ControlUnit, FaultsOfTransfersReachTheCaller) {
  run([](Machine& machine) {
    const Semaphore done = machine.allocate_semaphore("done");
    machine.async_copy_m2p(done, {0, 32}, cn::MonoPlaces::array(1 << 20, 32), LaneMask::first(8));
  });
  EXPECT_THROW(chip->control_unit.rethrow_failure(), cn::MachineFault);
}

TEST(CycleCauses, HaveNamesOfTheirOwn) {
  std::vector<std::string> names;
  for (int i = 0; i < model::kCycleCauses; ++i) names.push_back(model::cycle_cause_name(CycleCause(i)));
  EXPECT_EQ(names, (std::vector<std::string>{"poly", "stolen", "mono", "data_cache", "semaphore",
                                             "transfer_call", "wait_load", "wait_save", "wait_pio_queue",
                                             "wait_host", "thread_switch"}));
}

}  // namespace control_unit_test
