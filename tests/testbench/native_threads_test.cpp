#include "testbench/machine/native_threads.hpp"

#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "testbench/machine/native_machine.hpp"

namespace native_threads_test {

using cn::Machine;
using cn::MachineFault;
using cn::Semaphore;

constexpr int kAbove = cn::kFirstThreadPriority + 1;
constexpr int kBelow = cn::kFirstThreadPriority - 1;

class NativeThreads : public testing::Test {
 protected:
  std::string failure(const std::function<void(Machine&)>& firmware) {
    try {
      machine.run_firmware(firmware);
    } catch (const MachineFault& fault) {
      return fault.what();
    }
    return {};
  }
  testbench::NativeMachine machine{8, 1024, 65536};
  std::vector<std::string> order;
};

TEST_F(NativeThreads, OneRunsUntilItWaitsAndTheHighestPriorityGoesOn) {
  machine.run_firmware([&](Machine& chip) {
    const Semaphore go = chip.allocate_semaphore("go");
    for (const auto& [priority, name] : {std::pair{kBelow, "low"}, {kAbove, "high"}, {kBelow, "low 2"}})
      chip.start_thread(priority, name, [&, name = std::string(name)] {
        order.push_back(name);
        if (name == "high") chip.sem_signal(go);
      });
    order.push_back("first");
    chip.sem_wait(go);
    order.push_back("first again");
  });
  EXPECT_EQ(order, (std::vector<std::string>{"first", "high", "first again", "low", "low 2"}));
}

TEST_F(NativeThreads, TwoHandBlocksToAndFro) {
  std::vector<int> blocks;
  int block = -1;
  machine.run_firmware([&](Machine& chip) {
    const Semaphore full = chip.allocate_semaphore("full");
    const Semaphore empty = chip.allocate_semaphore("empty");
    chip.start_thread(kAbove, "loads", [&] {
      for (int i = 0; i < 1000; ++i) {
        chip.sem_wait(empty);
        block = i;
        chip.sem_signal(full);
      }
    });
    for (int i = 0; i < 1000; ++i) {
      chip.sem_signal(empty);
      chip.sem_wait(full);
      blocks.push_back(block);
    }
  });
  ASSERT_EQ(blocks.size(), 1000u);
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(blocks[std::size_t(i)], i);
}

/// Records when its stack is unwound.
struct Frame {
  int& left;
  ~Frame() { ++left; }
};

TEST_F(NativeThreads, DeadlockIsAFaultAndUnwindsAllStacks) {
  int frames_left = 0;
  const std::string fault = failure([&](Machine& chip) {
    const Frame frame{frames_left};
    const Semaphore full = chip.allocate_semaphore("full");
    const Semaphore empty = chip.allocate_semaphore("empty");
    chip.start_thread(kAbove, "loads", [&] {
      const Frame frame_of_thread{frames_left};
      chip.sem_wait(empty);
    });
    chip.sem_wait(full);
  });
  EXPECT_EQ(fault, "wait on semaphore 'empty' that nothing will signal");
  EXPECT_EQ(frames_left, 2);
}

TEST_F(NativeThreads, ThreadLeftWaitingBehindTheFirstIsAFault) {
  const Semaphore never = machine.allocate_semaphore("never");
  EXPECT_EQ(failure([&](Machine& chip) {
              chip.start_thread(kAbove, "stuck", [&chip, never] { chip.sem_wait(never); });
              chip.start_thread(kBelow, "well", [] {});
            }),
            "no thread can go on: 'stuck' waits on semaphore 'never'");
}

TEST_F(NativeThreads, WhatAThreadThrowsReachesTheCallerAndTheMachineCanRunAgain) {
  int frames_left = 0;
  const auto faulty = [&](Machine& chip) {
    const Frame frame{frames_left};
    const Semaphore never = chip.allocate_semaphore("never");
    chip.start_thread(kAbove, "faulty", [] { throw MachineFault("its own"); });
    chip.sem_wait(never);
  };
  EXPECT_EQ(failure(faulty), "its own");
  EXPECT_EQ(failure(faulty), "its own");
  EXPECT_EQ(frames_left, 2);
  EXPECT_EQ(failure([](Machine&) {}), "");
}

TEST_F(NativeThreads, StartOutsideARunIsAFault) {
  EXPECT_THROW(machine.start_thread(kAbove, "loads", [] {}), MachineFault);
}

}  // namespace native_threads_test
