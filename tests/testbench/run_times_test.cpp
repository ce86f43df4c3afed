#include "testbench/system/run_times.hpp"

#include <gtest/gtest.h>

namespace run_times_test {

using testbench::median;
using testbench::ratio;
using testbench::RunTimes;

TEST(RunTimes, MedianOfAnOddNumberIsTheMiddleOne) {
  EXPECT_EQ(median({5, 1, 100}), 5);
}

TEST(RunTimes, MedianOfAnEvenNumberIsTheMeanOfTheMiddleTwo) {
  EXPECT_EQ(median({8, 1, 2, 4}), 3);
}

TEST(RunTimes, RatioIsOfRunsThatFollowedEachOther) {
  // The machine was ten times slower during the second repetition. The ratio of medians would be 20 / 3.
  const RunTimes slow{{2, 20, 200}};
  const RunTimes fast{{1, 10, 3}};
  EXPECT_EQ(ratio(slow, fast), 2);
}

TEST(RunTimes, RatioIgnoresOneDisturbedRun) {
  EXPECT_EQ(ratio(RunTimes{{3, 90, 3}}, RunTimes{{1, 1, 1}}), 3);
}

}  // namespace run_times_test
