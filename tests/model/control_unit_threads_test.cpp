// Hardware threads on the chip: who has the control unit when, and what it costs.

#include <string>
#include <utility>
#include <vector>

#include "model/control/control_unit.hpp"
#include "tests/support/control_bench.hpp"

namespace control_unit_threads_test {

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

constexpr int kAbove = cn::kFirstThreadPriority + 1;
constexpr int kBelow = cn::kFirstThreadPriority - 1;

class ControlUnitThreads : public test_support::ControlBench {
 protected:
  Cycles now() const { return chip->control_unit.now() - kStart; }

  std::string failure() const {
    try {
      chip->control_unit.rethrow_failure();
    } catch (const cn::MachineFault& fault) {
      return fault.what();
    }
    return {};
  }
};

void compute(Machine& machine) {
  machine.run(kFake, issues(InstructionClass::fp64_add, 300), LaneMask::first(8));
}

constexpr int kBlocks = 4;

TEST_F(ControlUnitThreads, OneThreadOfSynchronousCopiesPaysForEachOfThem) {
  run_well([](Machine& machine) {
    const Semaphore done = machine.allocate_semaphore("done");
    for (int i = 0; i < kBlocks; ++i) {
      load(machine, done);
      machine.sem_wait(done);
      compute(machine);
    }
  });
  EXPECT_EQ(statistics().total(), kBlocks * (kRequestCycles + 300));
}

TEST_F(ControlUnitThreads, ThreadThatLoadsHidesItsCopiesBehindTheOneThatComputes) {
  run_well([](Machine& machine) {
    const Semaphore done = machine.allocate_semaphore("done");
    const Semaphore full = machine.allocate_semaphore("full");
    const Semaphore empty = machine.allocate_semaphore("empty");
    for (int i = 0; i < 2; ++i) machine.sem_signal(empty);
    machine.start_thread(kAbove, "loads", [&] {
      for (int i = 0; i < kBlocks; ++i) {
        machine.sem_wait(empty);
        load(machine, done);
        machine.sem_wait(done);
        machine.sem_signal(full);
      }
    });
    for (int i = 0; i < kBlocks; ++i) {
      machine.sem_wait(full);
      compute(machine);
      machine.sem_signal(empty);
    }
  });
  // The first load begins in cycle 3 after two signals and a wait, and ends in 215; the waits for it and for
  // `full` are over in 5. All others hide behind the kernels. 22 semaphore operations.
  EXPECT_EQ(spent(CycleCause::wait_load), 210u);
  EXPECT_EQ(spent(CycleCause::semaphore), 22u);
  EXPECT_EQ(spent(CycleCause::poly), kBlocks * 300u);
  EXPECT_EQ(statistics().total(), 210u + 22u + kBlocks * 300u);
  EXPECT_EQ(statistics().thread_switches, 14u);
}

TEST_F(ControlUnitThreads, ReadyThreadsRunByPriorityAndThenInTheOrderOfTheirStarts) {
  std::vector<std::string> order;
  run_well([&](Machine& machine) {
    const auto start = [&](int priority, const std::string& name) {
      machine.start_thread(priority, name, [&order, name] { order.push_back(name); });
    };
    start(kBelow, "low 1");
    start(cn::kFirstThreadPriority, "equal");
    start(kBelow - 1, "lowest");
    start(kBelow, "low 2");
    start(kAbove, "above");
    machine.issue_mono(10);
    order.push_back("first");
  });
  EXPECT_EQ(order, (std::vector<std::string>{"above", "first", "equal", "low 1", "low 2", "lowest"}));
}

TEST_F(ControlUnitThreads, ThreadOfHigherPriorityTakesOverBetweenTwoInstructions) {
  run_well([this](Machine& machine) {
    const Semaphore done = machine.allocate_semaphore("done");
    machine.start_thread(kAbove, "loads", [&] {
      load(machine, done);
      machine.sem_wait(done);  // in cycle 1; signalled in 212
      EXPECT_EQ(now(), 251u);
      machine.issue_mono(5);
    });
    for (int i = 0; i < 4; ++i) machine.issue_mono(50);
    EXPECT_EQ(now(), 201u);
    machine.issue_mono(50);
    EXPECT_EQ(now(), 256u);
  });
  EXPECT_EQ(statistics().exposed_pio(), 0u);
}

TEST_F(ControlUnitThreads, ThreadOfEqualPriorityDoesNotTakeOver) {
  run_well([this](Machine& machine) {
    machine.start_thread(cn::kFirstThreadPriority, "other", [&] {
      EXPECT_EQ(now(), 1001u);
      machine.issue_mono(5);
    });
    const Semaphore done = machine.allocate_semaphore("done");
    load(machine, done);
    for (int i = 0; i < 10; ++i) machine.issue_mono(100);
    machine.sem_wait(done);  // has its signal, so it goes on
    EXPECT_EQ(now(), 1001u);
  });
}

TEST_F(ControlUnitThreads, SwitchesCostWhatTheParameterSays) {
  const auto firmware = [](Machine& machine) {
    machine.start_thread(kAbove, "other", [&] { machine.issue_mono(5); });
    machine.issue_mono(7);
  };
  model::ChipConfig config = test_chip();
  config.control.thread_switch_cycles = 10;
  build(config);
  run_well(firmware);
  EXPECT_EQ(statistics().thread_switches, 2u);
  EXPECT_EQ(spent(CycleCause::thread_switch), 20u);
  EXPECT_EQ(statistics().total(), 32u);
}

TEST_F(ControlUnitThreads, EngineDecidesOnlyUpToTheNextRequestOfAReadyThread) {
  model::ChipConfig config = test_chip();
  config.pio.arbitration = model::PioArbitration::reads_overtake_writes;
  build(config);
  run_well([this](Machine& machine) {
    const Semaphore saved = machine.allocate_semaphore("saved");
    const Semaphore loaded = machine.allocate_semaphore("loaded");
    machine.start_thread(kBelow, "loads", [&] {
      machine.issue_mono(100);
      load(machine, loaded);  // while the first save is served, so before the second
      machine.sem_wait(loaded);
      EXPECT_EQ(now(), 2 * kRequestCycles);
    });
    save(machine, saved);
    save(machine, saved);
    machine.sem_wait(saved);
    EXPECT_EQ(now(), kRequestCycles);
    machine.sem_wait(saved);
    EXPECT_EQ(now(), 3 * kRequestCycles);
  });
}

TEST_F(ControlUnitThreads, EngineDecidesOnlyUpToTheNextRequestOfAThreadThatIsSignalledBefore) {
  model::ChipConfig config = test_chip();
  config.pio.arbitration = model::PioArbitration::reads_overtake_writes;
  build(config);
  run_well([this](Machine& machine) {
    const Semaphore first_saved = machine.allocate_semaphore("first saved");
    const Semaphore saved = machine.allocate_semaphore("saved");
    const Semaphore loaded = machine.allocate_semaphore("loaded");
    const Semaphore last_saved = machine.allocate_semaphore("last saved");
    save(machine, first_saved);
    save(machine, saved);
    save(machine, last_saved);
    machine.start_thread(kAbove, "loads", [&] {
      machine.sem_wait(first_saved);
      load(machine, loaded);  // while the second save is served
      machine.sem_wait(loaded);
      EXPECT_EQ(now(), 3 * kRequestCycles);
    });
    machine.sem_wait(last_saved);
    EXPECT_EQ(now(), 4 * kRequestCycles);
  });
}

TEST_F(ControlUnitThreads, StartOfOneMoreThanTheChipHasIsAFaultThatNamesTheLimit) {
  model::ChipConfig config = test_chip();
  config.control.threads = 2;
  build(config);
  run([](Machine& machine) {
    machine.start_thread(kBelow, "second", [] {});
    machine.start_thread(kBelow, "third", [] {});
  });
  EXPECT_EQ(
      failure(),
      "no hardware thread left for 'third': control.threads is 2, the firmware's first thread included");
}

TEST_F(ControlUnitThreads, ThreadsThatAreOverMakeRoomForOthers) {
  model::ChipConfig config = test_chip();
  config.control.threads = 2;
  build(config);
  run_well([](Machine& machine) {
    for (int i = 0; i < 20; ++i) machine.start_thread(kAbove, "short", [&] { machine.issue_mono(3); });
  });
  EXPECT_EQ(statistics().total(), 60u);
}

TEST_F(ControlUnitThreads, RunIsOverWhenAllThreadsAre) {
  bool other_over = false;
  run_well([&](Machine& machine) {
    // What the thread's body refers to outlives this function.
    machine.start_thread(kBelow, "other", [&machine, &other_over] {
      machine.issue_mono(100);
      machine.start_thread(kAbove, "third", [&machine] { machine.issue_mono(1000); });
      other_over = true;
    });
  });
  EXPECT_TRUE(other_over);
  EXPECT_EQ(statistics().total(), 1100u);
}

/// Says when its stack is unwound.
struct Frame {
  int& left;
  ~Frame() { ++left; }
};

TEST_F(ControlUnitThreads, DeadlockNamesAllThreadsAndWhatTheyWaitFor) {
  int frames_left = 0;
  run([&](Machine& machine) {
    const Frame frame{frames_left};
    const Semaphore full = machine.allocate_semaphore("full");
    const Semaphore empty = machine.allocate_semaphore("empty");
    machine.start_thread(kAbove, "loads", [&] {
      const Frame frame_of_thread{frames_left};
      machine.sem_wait(empty);
    });
    machine.issue_mono(20);
    machine.sem_wait(full);
  });
  EXPECT_EQ(failure(),
            "deadlock at cycle 1022: thread 'first' waits on semaphore 'full', thread 'loads' waits on "
            "semaphore 'empty'; nothing will signal any of them");
  EXPECT_TRUE(chip->control_unit.finished());
  EXPECT_EQ(frames_left, 2);
}

TEST_F(ControlUnitThreads, ExceptionsOfAnyThreadEndTheRunAndReachTheCaller) {
  int frames_left = 0;
  run([&](Machine& machine) {
    const Frame frame{frames_left};
    const Semaphore never = machine.allocate_semaphore("never");
    machine.start_thread(kBelow, "not run", [] { ADD_FAILURE() << "runs"; });
    machine.start_thread(kAbove, "faulty", [&] {
      machine.issue_mono(5);
      throw cn::MachineFault("the thread's own");
    });
    machine.sem_wait(never);
  });
  EXPECT_EQ(failure(), "the thread's own");
  EXPECT_EQ(frames_left, 1);
}

TEST_F(ControlUnitThreads, ApproximatelyTimedChipRefusesASecondThread) {
  build(test_chip(), model::TimingStyle::approximately_timed);
  run([](Machine& machine) { machine.start_thread(kAbove, "loads", [] {}); });
  EXPECT_EQ(
      failure(),
      "start of thread 'loads': an approximately timed chip runs one hardware thread; run it loosely timed");
}

/// Answers the signal of semaphore 0 with one of semaphore 1, 500 cycles later.
class SlowHost : public sc_core::sc_module {
 public:
  SlowHost(const sc_core::sc_module_name& name, model::Csx600& chip) : sc_module(name), chip_(chip) {
    for (const int index : {0, 1}) chip_.control_unit.host_semaphores().share({index});
    SC_HAS_PROCESS(SlowHost);
    SC_THREAD(run);
  }

 private:
  void run() {
    wait(chip_.control_unit.host_semaphores().firmware_signalled());
    if (!chip_.control_unit.host_semaphores().try_wait({0})) return;
    wait(chip_.clock.time_at(500));
    chip_.control_unit.host_semaphores().signal({1});
  }
  model::Csx600& chip_;
};

TEST_F(ControlUnitThreads, WhileOneWaitsForTheHostAnotherRuns) {
  build(test_chip());
  SlowHost host("host", *chip);
  run_well([this](Machine& machine) {
    const Semaphore to_host = machine.allocate_semaphore("to host");
    const Semaphore from_host = machine.allocate_semaphore("from host");
    machine.start_thread(kAbove, "talks", [&machine, to_host, from_host, this] {
      machine.sem_signal(to_host);  // in cycle 1; answered in 501
      machine.sem_wait(from_host);
      EXPECT_EQ(now(), 502u);
    });
    for (int i = 0; i < 6; ++i) machine.issue_mono(100);
  });
  EXPECT_EQ(spent(CycleCause::wait_host), 0u);
  EXPECT_EQ(statistics().total(), 602u);
}

TEST_F(ControlUnitThreads, AllWaitForTheHostOrTransfersUntilTheFirstIsSignalled) {
  build(test_chip());
  SlowHost host("host", *chip);
  run_well([this](Machine& machine) {
    const Semaphore to_host = machine.allocate_semaphore("to host");
    const Semaphore from_host = machine.allocate_semaphore("from host");
    const Semaphore done = machine.allocate_semaphore("done");
    machine.start_thread(kAbove, "talks", [&machine, to_host, from_host, this] {
      machine.sem_signal(to_host);  // in cycle 1; answered in 501
      machine.sem_wait(from_host);
      EXPECT_EQ(now(), 501u);
    });
    load(machine, done);
    load(machine, done);
    machine.sem_wait(done);
    EXPECT_EQ(now(), 2 + kRequestCycles);
    machine.sem_wait(done);
    EXPECT_EQ(now(), 2 + 2 * kRequestCycles);
  });
}

/// Spans have no gaps, however often the observer synchronises.
class Spans : public model::ControlObserver {
 public:
  void spent(CycleCause cause, Cycles start, Cycles finish, int) override {
    EXPECT_EQ(start, end);
    end = finish;
    all.emplace_back(cause, finish);
  }
  void ran_kernel(const char*, Cycles, Cycles, int) override {}
  Cycles end = kStart;
  std::vector<std::pair<CycleCause, Cycles>> all;
};

std::vector<std::pair<CycleCause, Cycles>> spans_of_busy_firmware(Cycles sync_cycles) {
  struct Bench : test_support::ControlBench {
    void TestBody() override {}
    /// Three threads that come in each other's way.
    static void busy_firmware(Machine& machine) {
      const Semaphore loaded = machine.allocate_semaphore("loaded");
      const Semaphore saved = machine.allocate_semaphore("saved");
      const Semaphore ready = machine.allocate_semaphore("ready");
      const Semaphore over = machine.allocate_semaphore("over");
      machine.start_thread(kAbove, "loads", [&] {
        for (int i = 0; i < 30; ++i) {
          load(machine, loaded);
          machine.sem_wait(loaded);
          machine.sem_signal(ready);
        }
        machine.sem_signal(over);
      });
      machine.start_thread(kAbove + 1, "saves", [&] {
        for (int i = 0; i < 30; ++i) {
          save(machine, saved);
          machine.issue_mono(std::uint64_t(13 * i));
          machine.sem_wait(saved);
        }
        machine.sem_signal(over);
      });
      for (int i = 0; i < 30; ++i) {
        machine.sem_wait(ready);
        compute(machine);
        machine.read_mono(cn::MonoPointer<double>{std::uint64_t(64 * i)});
      }
      for (int i = 0; i < 2; ++i) machine.sem_wait(over);
    }
    std::vector<std::pair<CycleCause, Cycles>> spans(Cycles sync) {
      build(test_chip());
      Spans recorder;
      chip->control_unit.set_observer(&recorder, sync);
      run_well(busy_firmware);
      EXPECT_EQ(chip->pio_engine.statistics().late_starts, 0u);
      return recorder.all;
    }
  } bench;
  return bench.spans(sync_cycles);
}

TEST(ControlUnitThreadsObserved, SpansAreTheSameEachTimeAndHoweverOftenSystemCTimeCatchesUp) {
  const auto spans = spans_of_busy_firmware(1);
  EXPECT_GT(spans.size(), 4 * 30u);  // at least a kernel, a line fetch and two waits a round
  EXPECT_EQ(spans_of_busy_firmware(1), spans);
  EXPECT_EQ(spans_of_busy_firmware(1000000), spans);
}

}  // namespace control_unit_threads_test
