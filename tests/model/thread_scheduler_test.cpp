#include "model/control/thread_scheduler.hpp"

#include <gtest/gtest.h>

namespace thread_scheduler_test {

using model::SemaphoreFile;
using model::ThreadScheduler;

class ThreadSchedulerOfEight : public testing::Test {
 protected:
  ThreadScheduler threads{8, 0};
  SemaphoreFile semaphores;
};

TEST_F(ThreadSchedulerOfEight, RunsTheFirstThreadAtFirst) {
  EXPECT_EQ(threads.running(), 0);
  EXPECT_EQ(threads.alive(), 1);
  EXPECT_FALSE(threads.takes_over(semaphores, 100));
}

TEST_F(ThreadSchedulerOfEight, OnlyAHigherPriorityTakesOver) {
  threads.start(0, "equal");
  threads.start(-1, "below");
  EXPECT_FALSE(threads.takes_over(semaphores, 100));
  const int above = threads.start(1, "above");
  EXPECT_EQ(threads.takes_over(semaphores, 100), above);
}

TEST_F(ThreadSchedulerOfEight, NextIsTheEarliestThatIsReadyBeforeTheHighestPriority) {
  const int above = threads.start(1, "above");
  threads.run(above);
  threads.wait(5);
  threads.run(0);
  threads.wait(6);
  EXPECT_FALSE(threads.next(semaphores, 100));
  semaphores.signal(5, 300);
  semaphores.signal(6, 200);
  EXPECT_EQ(threads.next(semaphores, 100)->thread, 0);
  EXPECT_EQ(threads.next(semaphores, 100)->cycle, 200u);
  EXPECT_EQ(threads.next(semaphores, 300)->thread, above);
  EXPECT_EQ(threads.next(semaphores, 400)->cycle, 400u);
}

TEST_F(ThreadSchedulerOfEight, SlotsOfThreadsThatAreOverAreUsedAgainButComeLastAmongEquals) {
  const int second = threads.start(0, "second");
  const int third = threads.start(0, "third");
  threads.run(second);
  threads.end();
  EXPECT_EQ(threads.start(0, "fourth"), second);
  threads.run(0);
  threads.wait(1);
  EXPECT_EQ(threads.next(semaphores, 100)->thread, third);
}

TEST_F(ThreadSchedulerOfEight, StartsNoMoreThanItsLimit) {
  for (int i = 1; i < 8; ++i) EXPECT_EQ(threads.start(0, "further"), i);
  EXPECT_THROW(threads.start(0, "ninth"), cn::MachineFault);
}

TEST_F(ThreadSchedulerOfEight, SaysWhoWaitsForWhat) {
  EXPECT_EQ(threads.waits({"a", "b"}), "");
  threads.wait(1);
  threads.run(threads.start(0, "other"));
  threads.wait(0);
  EXPECT_EQ(threads.waits({"a", "b"}),
            "thread 'first' waits on semaphore 'b', thread 'other' waits on semaphore 'a'");
}

}  // namespace thread_scheduler_test
