#include "model/control/semaphore_file.hpp"

#include <gtest/gtest.h>

namespace semaphore_file_test {

using model::SemaphoreFile;

TEST(SemaphoreFile, HasNothingToTakeAtFirst) {
  SemaphoreFile semaphores;
  for (int i = 0; i < cn::Machine::kSemaphores; ++i) {
    EXPECT_FALSE(semaphores.take(i).has_value());
    EXPECT_FALSE(semaphores.has_signal(i, ~model::Cycles{0}));
  }
}

TEST(SemaphoreFile, GivesSignalsInTheOrderOfTheirCycles) {
  SemaphoreFile semaphores;
  for (const model::Cycles at : {500u, 100u, 300u, 100u, 700u}) semaphores.signal(5, at);
  for (const model::Cycles at : {100u, 100u, 300u, 500u, 700u}) EXPECT_EQ(semaphores.take(5), at);
  EXPECT_FALSE(semaphores.take(5).has_value());
}

TEST(SemaphoreFile, KeepsSemaphoresApart) {
  SemaphoreFile semaphores;
  semaphores.signal(0, 10);
  semaphores.signal(63, 20);
  EXPECT_FALSE(semaphores.take(1).has_value());
  EXPECT_EQ(semaphores.take(63), 20u);
  EXPECT_EQ(semaphores.take(0), 10u);
}

TEST(SemaphoreFile, KnowsSignalsBeforeTheyArrive) {
  SemaphoreFile semaphores;
  semaphores.signal(2, 100);
  EXPECT_FALSE(semaphores.has_signal(2, 99));
  EXPECT_TRUE(semaphores.has_signal(2, 100));
  EXPECT_EQ(semaphores.take(2), 100u);  // a wait may take it early and block until then
}

TEST(SemaphoreFile, RefusesNumbersTheChipDoesNotHave) {
  SemaphoreFile semaphores;
  EXPECT_THROW(semaphores.signal(cn::Machine::kSemaphores, 0), std::out_of_range);
  EXPECT_THROW(semaphores.take(-1), std::out_of_range);
}

}  // namespace semaphore_file_test
