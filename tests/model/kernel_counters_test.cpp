// What the chip counts kernel by kernel: waits for its data, and instructions that enabled PEs executed.

#include "tests/support/control_bench.hpp"

namespace kernel_counters_test {

using cn::InstructionClass;
using cn::LaneMask;
using cn::Machine;
using cn::Semaphore;
using model::CycleCause;
using model::KernelStatistics;
using test_support::FakeArguments;
using test_support::issues;
using test_support::kFake;

constexpr cn::Kernel<FakeArguments> kOther{"other", &test_support::run_fake};

class KernelCounters : public test_support::ControlBench {
 protected:
  KernelStatistics kernel(const std::string& name) const {
    for (const KernelStatistics& of : chip->pe_array.kernels())
      if (of.name == name) return of;
    throw std::runtime_error("no kernel " + name);
  }
};

FakeArguments work() {
  return issues(InstructionClass::fp64_add, 10);
}

TEST_F(KernelCounters, WaitsBelongToTheKernelThatFollows) {
  run_well([](Machine& machine) {
    const Semaphore loaded = machine.allocate_semaphore("loaded");
    const Semaphore saved = machine.allocate_semaphore("saved");
    load(machine, loaded);
    machine.sem_wait(loaded);
    machine.run(kFake, work(), LaneMask::first(8));
    save(machine, saved);
    machine.run(kOther, work(), LaneMask::first(8));  // without a wait
    machine.sem_wait(saved);
    machine.run(kFake, work(), LaneMask::first(8));
    load(machine, loaded);
    machine.sem_wait(loaded);
  });
  const model::PioWaits fake = kernel("fake").waited_before;
  EXPECT_GT(fake.load, 200u);
  EXPECT_EQ(fake.save, spent(CycleCause::wait_save));
  EXPECT_GT(fake.save, 0u);
  EXPECT_EQ(fake.queue, 0u);
  EXPECT_EQ(kernel("other").waited_before.total(), 0u);
  // The last load is as long as the first; no kernel needed it.
  EXPECT_EQ(2 * fake.load, spent(CycleCause::wait_load));
  EXPECT_EQ(chip->pe_array.total().waited_before.total() + fake.load, statistics().exposed_pio());
}

TEST_F(KernelCounters, FullQueueHoldsUpTheKernelThatFollows) {
  run_well([](Machine& machine) {
    const Semaphore saved = machine.allocate_semaphore("saved");
    machine.run(kOther, work(), LaneMask::first(8));
    for (int request = 0; request < 12; ++request) save(machine, saved);
    machine.run(kFake, work(), LaneMask::first(8));
  });
  EXPECT_GT(kernel("fake").waited_before.queue, 0u);
  EXPECT_EQ(kernel("fake").waited_before.queue, spent(CycleCause::wait_pio_queue));
  EXPECT_EQ(kernel("other").waited_before.total(), 0u);
}

TEST_F(KernelCounters, ExecutedIsIssuedByEnabledPes) {
  run_well([](Machine& machine) {
    FakeArguments words = work();
    words.issued[InstructionClass::sram] = 7;
    machine.run(kFake, words, LaneMask::first(3));
    machine.run(kFake, words, LaneMask::first(8));
    machine.run(kOther, words, LaneMask::first(1));
  });
  EXPECT_EQ(kernel("fake").issued[InstructionClass::sram], 14u);
  EXPECT_EQ(kernel("fake").executed[InstructionClass::sram], 7u * 11);
  EXPECT_EQ(kernel("fake").executed[InstructionClass::fp64_add], 10u * 11);
  EXPECT_EQ(chip->pe_array.total().executed[InstructionClass::fp64_add], 10u * 12);
}

TEST_F(KernelCounters, RunsAreCountedByThePesThatTheyBeganWith) {
  run_well([](Machine& machine) {
    for (const int pes : {1, 3, 3, 8, 8, 8, 0}) machine.run(kFake, work(), LaneMask::first(pes));
  });
  EXPECT_EQ(kernel("fake").runs_by_enabled_pes, (std::vector<std::uint64_t>{0, 1, 0, 2, 0, 0, 0, 0, 3}));
}

}  // namespace kernel_counters_test
