#include "testbench/sampling/time_budget.hpp"

#include <gtest/gtest.h>

namespace time_budget_test {

using testbench::parse_duration;
using testbench::PassTimes;

TEST(TimeBudget, ReadsNumbersWithUnits) {
  EXPECT_EQ(parse_duration("2s"), 2.0);
  EXPECT_EQ(parse_duration("1.5 min"), 90.0);
  EXPECT_EQ(parse_duration("250ms"), 250 * 1e-3);
  EXPECT_EQ(parse_duration("20us"), 20 * 1e-6);
  EXPECT_EQ(parse_duration(".5s"), 0.5);
  EXPECT_EQ(parse_duration("1e3ms"), 1e3 * 1e-3);
}

TEST(TimeBudget, TakesNothingElse) {
  for (const char* const text : {"", "2", "s", "0s", "-1s", "+1s", "nan s", "infs", "1e999s", "1e-400s",
                                 "0x2s", "2h", "2ss", "2s ", " 2s", "2 s s", "1,5s", "2S"})
    EXPECT_EQ(parse_duration(text), std::nullopt) << text;
}

/// Passes that take a time each and a time for each path.
double seconds_of(double paths) {
  return 0.02 + 1e-5 * paths;
}

TEST(TimeBudget, PredictsPassesThatAreNotLate) {
  PassTimes times;
  EXPECT_FALSE(times.any());
  for (const double paths : {1000.0, 1000.0, 2000.0, 4000.0}) {
    times.add(paths, seconds_of(paths));
    for (const double seconds : {0.05, 0.1, 1.0}) {
      const double most = times.most_paths(seconds);
      EXPECT_LE(most == 0 ? 0 : seconds_of(most), seconds);
    }
  }
  EXPECT_GT(seconds_of(times.most_paths(1.0)), 0.6) << "nor does it waste the time";
  EXPECT_EQ(times.most_paths(0.001), 0);
}

}  // namespace time_budget_test
