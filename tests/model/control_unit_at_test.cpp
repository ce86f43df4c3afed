// The control unit approximately timed: it does not run ahead, and its mono accesses contend packet by
// packet.

#include "model/control/control_unit.hpp"
#include "tests/support/control_bench.hpp"

namespace control_unit_at_test {

using cn::InstructionClass;
using cn::LaneMask;
using cn::Machine;
using cn::Semaphore;
using model::CycleCause;
using model::Cycles;
using model::TimingStyle;
using test_support::issues;
using test_support::kFake;
using test_support::kStart;
using test_support::test_chip;

class ControlUnitAt : public test_support::ControlBench {
 protected:
  void build_at(const model::ChipConfig& config) { build(config, TimingStyle::approximately_timed); }
  static Cycles now() { return Cycles(sc_core::sc_time_stamp() / sc_core::sc_time(1, sc_core::SC_NS)); }
};

TEST_F(ControlUnitAt, TimeHasComeAtEachKernelEndRequestAndWait) {
  build_at(test_chip());
  run_well([](Machine& machine) {
    const Semaphore done = machine.allocate_semaphore("done");
    machine.run(kFake, issues(InstructionClass::fp64_add, 100), LaneMask::first(8));
    EXPECT_EQ(now(), kStart + 100);
    machine.issue_mono(7);
    EXPECT_EQ(now(), kStart + 100);  // nobody can see that
    load(machine, done);
    EXPECT_EQ(now(), kStart + 107);
    machine.sem_wait(done);
    EXPECT_EQ(now(), kStart + 107 + 218);  // see at_pio_test.cpp
  });
  EXPECT_EQ(spent(CycleCause::wait_load), 218u - 1u);
  EXPECT_EQ(spent(CycleCause::semaphore), 1u);
}

TEST_F(ControlUnitAt, KernelAndTransferOverlap) {
  build_at(test_chip());
  run_well([](Machine& machine) {
    const Semaphore done = machine.allocate_semaphore("done");
    load(machine, done);
    machine.run(kFake, issues(InstructionClass::fp64_add, 300), LaneMask::first(8));
    machine.sem_wait(done);
  });
  EXPECT_EQ(spent(CycleCause::wait_load), 0u);
  EXPECT_EQ(statistics().total(), 301u);
}

TEST_F(ControlUnitAt, SramPortsAreStolenWhileDataMove) {
  build_at(test_chip());
  run_well([](Machine& machine) {
    const Semaphore done = machine.allocate_semaphore("done");
    load(machine, done);
    machine.run(kFake, issues(InstructionClass::sram, 300), LaneMask::first(8));
    machine.sem_wait(done);
  });
  EXPECT_EQ(spent(CycleCause::stolen), 32u);  // 8 PEs, 4 words each
}

TEST_F(ControlUnitAt, MonoWritesAreInMemoryWhenTheyAreOver) {
  build_at(test_chip());
  run_well([this](Machine& machine) {
    machine.write_mono(cn::MonoPointer<std::uint64_t>{640}, std::uint64_t{42});
    EXPECT_EQ(mono()[640], 42);
    EXPECT_EQ(*machine.read_mono(cn::MonoPointer<std::uint64_t>{640}), 42u);
  });
  EXPECT_EQ(statistics().data_cache_misses, 1u);
}

TEST_F(ControlUnitAt, LineFetchCostsWhatItDoesLooselyTimedWhenNobodyElseIsThere) {
  const auto fetch = [](Machine& machine) { machine.read_mono(cn::MonoPointer<std::uint64_t>{640}); };
  run_well(fetch);
  const Cycles loose = spent(CycleCause::data_cache);
  chip.reset();
  sc_core::sc_curr_simcontext = new sc_core::sc_simcontext();
  sc_core::sc_default_global_context = sc_core::sc_curr_simcontext;
  build_at(test_chip());
  run_well(fetch);
  EXPECT_EQ(spent(CycleCause::data_cache), loose);
}

/// A line is fetched amid a request of 16 packets that come 2 every 116 cycles and take 64 of the memory.
Cycles fetch_beside_request(TimingStyle timing) {
  struct Bench : test_support::ControlBench {
    void TestBody() override {}
    Cycles measure(TimingStyle style) {
      model::ChipConfig config = test_chip();
      config.ddr.bytes_per_cycle = 2;
      config.pio.per_pe_cycles = 100;
      build(config, style);
      run_well([](Machine& machine) {
        const Semaphore done = machine.allocate_semaphore("done");
        machine.async_copy_m2p(done, {0, 128}, cn::MonoPlaces::array(0, 128), LaneMask::first(8));
        machine.issue_mono(250);
        machine.read_mono(cn::MonoPointer<std::uint64_t>{65536});
        machine.sem_wait(done);
      });
      return spent(CycleCause::data_cache);
    }
  } bench;
  return bench.measure(timing);
}

TEST(ControlUnitStyles, LineFetchGetsBetweenThePacketsOfARequest) {
  const Cycles loose = fetch_beside_request(TimingStyle::loosely_timed);
  const Cycles approximate = fetch_beside_request(TimingStyle::approximately_timed);
  EXPECT_GT(loose, 300u);  // behind the whole request
  EXPECT_LT(approximate, 200u);
}

TEST_F(ControlUnitAt, WaitThatNobodyWillEndIsADeadlock) {
  build_at(test_chip());
  run([](Machine& machine) { machine.sem_wait(machine.allocate_semaphore("nobody")); });
  EXPECT_THROW(chip->control_unit.rethrow_failure(), cn::MachineFault);
}

}  // namespace control_unit_at_test
