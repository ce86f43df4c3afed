// The control unit and what lies outside the chip: semaphores shared with the host, observers, a memory of
// another make.

#include <cstring>
#include <tuple>
#include <vector>

#include "model/control/control_unit.hpp"
#include "tests/support/control_bench.hpp"

namespace control_unit_host_test {

using cn::InstructionClass;
using cn::LaneMask;
using cn::Machine;
using cn::Semaphore;
using model::CycleCause;
using model::Cycles;
using test_support::issues;
using test_support::kFake;
using test_support::kStart;
using test_support::test_chip;

constexpr Semaphore kToHost{0};
constexpr Semaphore kFromHost{1};

/// Answers each signal after a while.
class SlowHost : public sc_core::sc_module {
 public:
  SlowHost(const sc_core::sc_module_name& name, model::Csx600& chip, Cycles answer_cycles)
      : sc_module(name), chip_(chip), answer_cycles_(answer_cycles) {
    chip_.control_unit.host_semaphores().share(kToHost);
    chip_.control_unit.host_semaphores().share(kFromHost);
    SC_HAS_PROCESS(SlowHost);
    SC_THREAD(run);
  }
  std::vector<Cycles> seen;

 private:
  void run() {
    while (true) {
      wait(chip_.control_unit.host_semaphores().firmware_signalled());
      while (chip_.control_unit.host_semaphores().try_wait(kToHost)) {
        seen.push_back(chip_.clock.cycle_at(sc_core::sc_time_stamp()));
        if (answer_cycles_ > 0) wait(chip_.clock.time_at(answer_cycles_));
        chip_.control_unit.host_semaphores().signal(kFromHost);
      }
    }
  }
  model::Csx600& chip_;
  Cycles answer_cycles_;
};

class ControlUnitHost : public test_support::ControlBench {
 protected:
  ControlUnitHost() { build(test_chip()); }
  static void allocate_host_semaphores(Machine& machine) {
    ASSERT_EQ(machine.allocate_semaphore("to host").index, kToHost.index);
    ASSERT_EQ(machine.allocate_semaphore("from host").index, kFromHost.index);
  }
};

TEST_F(ControlUnitHost, SeesSignalsInTheCycleTheyAreGiven) {
  SlowHost host("host", *chip, 500);
  run_well([](Machine& machine) {
    allocate_host_semaphores(machine);
    machine.issue_mono(100);
    machine.sem_signal(kToHost);
    machine.issue_mono(1000);
    machine.sem_signal(kToHost);
  });
  EXPECT_EQ(host.seen, (std::vector<Cycles>{kStart + 101, kStart + 1102}));
}

TEST_F(ControlUnitHost, WaitForTheHostIsBooked) {
  SlowHost host("host", *chip, 500);
  run_well([](Machine& machine) {
    allocate_host_semaphores(machine);
    machine.issue_mono(100);
    machine.sem_signal(kToHost);  // in cycle 101; answered in 601
    machine.sem_wait(kFromHost);
  });
  EXPECT_EQ(spent(CycleCause::wait_host), 601u - 102u);
  EXPECT_EQ(statistics().total(), 601u);
}

TEST_F(ControlUnitHost, AnswerThatCameBeforeTheWaitCostsNothing) {
  SlowHost host("host", *chip, 500);
  run_well([](Machine& machine) {
    allocate_host_semaphores(machine);
    machine.sem_signal(kToHost);  // in cycle 1; answered in 501
    machine.run(kFake, issues(InstructionClass::fp64_add, 600), LaneMask::first(8));
    machine.sem_wait(kFromHost);
  });
  EXPECT_EQ(spent(CycleCause::wait_host), 0u);
  EXPECT_EQ(statistics().total(), 602u);
}

TEST_F(ControlUnitHost, TransfersGoOnWhileTheControlUnitWaitsForTheHost) {
  SlowHost host("host", *chip, 5000);
  run_well([](Machine& machine) {
    allocate_host_semaphores(machine);
    const Semaphore done = machine.allocate_semaphore("done");
    for (int i = 0; i < 3; ++i) load(machine, done);
    machine.sem_signal(kToHost);
    machine.sem_wait(kFromHost);
    for (int i = 0; i < 3; ++i) machine.sem_wait(done);  // over long ago
  });
  EXPECT_EQ(chip->pio_engine.statistics().late_starts, 0u);
  EXPECT_EQ(spent(CycleCause::wait_load), 0u);
  EXPECT_EQ(statistics().total(), 5001u + 3u);
}

TEST_F(ControlUnitHost, NothingToTakeWithoutASignal) {
  run_well([this](Machine& machine) {
    allocate_host_semaphores(machine);
    EXPECT_FALSE(chip->control_unit.host_semaphores().try_wait(kToHost));
    machine.issue_mono(10);
  });
  EXPECT_FALSE(chip->control_unit.host_semaphores().try_wait(kToHost));
}

TEST_F(ControlUnitHost, FinishedEventFollowsTheLastCycle) {
  sc_core::sc_time finished;
  struct Watcher : sc_core::sc_module {
    Watcher(const sc_core::sc_module_name& name, model::Csx600& chip, sc_core::sc_time& at)
        : sc_module(name), chip_(chip), at_(at) {
      SC_HAS_PROCESS(Watcher);
      SC_THREAD(run);
    }
    void run() {
      wait(chip_.control_unit.finished_event());
      at_ = sc_core::sc_time_stamp();
    }
    model::Csx600& chip_;
    sc_core::sc_time& at_;
  } watcher("watcher", *chip, finished);
  run_well([](Machine& machine) { machine.issue_mono(123); });
  EXPECT_EQ(finished, sc_core::sc_time(kStart + 123, sc_core::SC_NS));
}

/// Notes every span.
class Recorder : public model::ControlObserver {
 public:
  void spent(CycleCause cause, Cycles start, Cycles finish, int semaphore) override {
    spans.emplace_back(cause, start - kStart, finish - kStart, semaphore);
  }
  void ran_kernel(const char* name, Cycles start, Cycles finish, int enabled_pes) override {
    kernels.emplace_back(name, start - kStart, finish - kStart, enabled_pes);
  }
  std::vector<std::tuple<CycleCause, Cycles, Cycles, int>> spans;
  std::vector<std::tuple<std::string, Cycles, Cycles, int>> kernels;
};

TEST_F(ControlUnitHost, ObserverIsToldEverySpan) {
  Recorder recorder;
  chip->control_unit.set_observer(&recorder, 10);
  run_well([](Machine& machine) {
    const Semaphore done = machine.allocate_semaphore("done");
    load(machine, done);
    machine.issue_mono(10);
    machine.run(kFake, issues(InstructionClass::fp64_add, 30), LaneMask::first(5));
    machine.sem_wait(done);
    machine.issue_mono(0);  // takes no cycle
  });
  EXPECT_EQ(recorder.spans, (std::vector<std::tuple<CycleCause, Cycles, Cycles, int>>{
                                {CycleCause::mono, 0, 10, -1},
                                {CycleCause::poly, 10, 40, -1},
                                {CycleCause::semaphore, 40, 41, 0},
                                {CycleCause::wait_load, 41, kRequestCycles, 0}}));
  EXPECT_EQ(recorder.kernels,
            (std::vector<std::tuple<std::string, Cycles, Cycles, int>>{{"fake", 10, 40, 5}}));
}

TEST_F(ControlUnitHost, ObserverLetsTimePassBehindTheFirmware) {
  Recorder recorder;
  chip->control_unit.set_observer(&recorder, 100);
  run_well([](Machine& machine) {
    machine.run(kFake, issues(InstructionClass::fp64_add, 100), LaneMask::first(8));
    EXPECT_EQ(sc_core::sc_time_stamp(), sc_core::sc_time(kStart + 100, sc_core::SC_NS));
    machine.run(kFake, issues(InstructionClass::fp64_add, 99), LaneMask::first(8));
    EXPECT_EQ(sc_core::sc_time_stamp(), sc_core::sc_time(kStart + 100, sc_core::SC_NS));
    machine.run(kFake, issues(InstructionClass::fp64_add, 1), LaneMask::first(8));
    EXPECT_EQ(sc_core::sc_time_stamp(), sc_core::sc_time(kStart + 200, sc_core::SC_NS));
  });
}

TEST_F(ControlUnitHost, WithoutAnObserverTheFirmwareRunsAhead) {
  run_well([](Machine& machine) {
    machine.run(kFake, issues(InstructionClass::fp64_add, 1000000), LaneMask::first(8));
    EXPECT_EQ(sc_core::sc_time_stamp(), sc_core::sc_time(kStart, sc_core::SC_NS));
  });
  EXPECT_EQ(sc_core::sc_time_stamp(), sc_core::sc_time(kStart + 1000000, sc_core::SC_NS));
}

/// Takes back the direct pointer it has granted, and keeps its data elsewhere from then on.
class MovingMemory : public sc_core::sc_module {
 public:
  tlm_utils::simple_target_socket<MovingMemory> socket{"socket"};
  explicit MovingMemory(const sc_core::sc_module_name& name) : sc_module(name), here_(1 << 20, 1) {
    socket.register_b_transport(this, &MovingMemory::b_transport);
    socket.register_get_direct_mem_ptr(this, &MovingMemory::get_direct_mem_ptr);
    socket.register_transport_dbg(this, &MovingMemory::transport_dbg);
  }
  void move() {
    there_.assign(here_.size(), 2);
    socket->invalidate_direct_mem_ptr(0, here_.size() - 1);
  }

 private:
  void b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time&) {
    transaction.set_response_status(tlm::TLM_OK_RESPONSE);
  }
  bool get_direct_mem_ptr(tlm::tlm_generic_payload&, tlm::tlm_dmi& dmi) {
    dmi.init();
    dmi.set_end_address(here_.size() - 1);
    dmi.set_dmi_ptr(here_.data());
    dmi.allow_read_write();
    return there_.empty();
  }
  unsigned int transport_dbg(tlm::tlm_generic_payload& transaction) {
    std::memcpy(transaction.get_data_ptr(), there_.data() + transaction.get_address(),
                transaction.get_data_length());
    return transaction.get_data_length();
  }
  std::vector<std::uint8_t> here_;
  std::vector<std::uint8_t> there_;
};

/// A PIO engine that is never asked for anything.
class NoPio : public model::PioPort {
 public:
  Cycles enqueue(const cn::Transfer&, Cycles now) override { return now; }
  void settle(Cycles) override {}
  bool serve_next() override { return false; }
  std::optional<Cycles> next_start() const override { return std::nullopt; }
  std::uint64_t words_moved_before(Cycles) const override { return 0; }
};

class ControlUnitAlone : public test_support::SystemCFixture {};

TEST_F(ControlUnitAlone, PointerToMonoMemoryIsGivenUpWhenTheMemoryTakesItBack) {
  const model::ChipConfig config = test_chip();
  const model::ClockDomain clock(config.chip.clock_hz);
  model::PeArray pe_array("pe_array", config);
  model::ControlUnit control_unit("control_unit", config, clock, pe_array);
  MovingMemory memory("memory");
  NoPio no_pio;
  control_unit.pio.bind(no_pio);
  control_unit.mono_socket.bind(memory.socket);
  control_unit.load([&](Machine& machine) {
    EXPECT_EQ(*machine.read_mono(cn::MonoPointer<std::uint8_t>{64}), 1);
    memory.move();
    EXPECT_EQ(*machine.read_mono(cn::MonoPointer<std::uint8_t>{64}), 2);
  });
  elaborate();
  control_unit.start();
  sc_core::sc_start();
  control_unit.rethrow_failure();
  EXPECT_TRUE(control_unit.finished());
}

}  // namespace control_unit_host_test
