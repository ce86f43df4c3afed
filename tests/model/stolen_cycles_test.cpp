#include "model/pe_array/stolen_cycles.hpp"

#include <gtest/gtest.h>

namespace stolen_cycles_test {

using model::stolen_cycles;

TEST(StolenCycles, OnlyCyclesInWhichTheKernelAccessesSramAreLost) {
  EXPECT_EQ(stolen_cycles(1000, 1, 250, 1000), 250u);
  EXPECT_EQ(stolen_cycles(1000, 2, 250, 1000), 500u);
  EXPECT_EQ(stolen_cycles(1000, 1, 1000, 1000), 1000u);
  EXPECT_EQ(stolen_cycles(1000, 1, 0, 1000), 0u);
  EXPECT_EQ(stolen_cycles(0, 1, 250, 1000), 0u);
}

TEST(StolenCycles, RoundsToTheNearestCycle) {
  EXPECT_EQ(stolen_cycles(1, 1, 499, 1000), 0u);
  EXPECT_EQ(stolen_cycles(1, 1, 500, 1000), 1u);
}

TEST(StolenCycles, EmptyKernelLosesNothing) {
  EXPECT_EQ(stolen_cycles(100, 1, 0, 0), 0u);
}

}  // namespace stolen_cycles_test
