#include "firmware/cn/chip/lane_mask.hpp"

#include <gtest/gtest.h>

namespace lane_mask_test {

using cn::kMaxPes;
using cn::LaneMask;

LaneMask multiples_of(int divisor) {
  LaneMask mask;
  for (int pe = 0; pe < kMaxPes; pe += divisor) mask.set(pe, true);
  return mask;
}

TEST(LaneMask, WithHoldsThePesOfEither) {
  const LaneMask both = multiples_of(2).with(multiples_of(3));
  for (int pe = 0; pe < kMaxPes; ++pe) EXPECT_EQ(both[pe], pe % 2 == 0 || pe % 3 == 0) << pe;
}

TEST(LaneMask, WithoutHoldsThePesOfTheFirstOnly) {
  const LaneMask rest = multiples_of(2).without(multiples_of(3));
  for (int pe = 0; pe < kMaxPes; ++pe) EXPECT_EQ(rest[pe], pe % 2 == 0 && pe % 3 != 0) << pe;
}

TEST(LaneMask, NothingAddsAndTakesNothing) {
  const LaneMask some = multiples_of(5);
  EXPECT_EQ(some.with(LaneMask{}), some);
  EXPECT_EQ(some.without(LaneMask{}), some);
  EXPECT_EQ(LaneMask{}.with(some), some);
  EXPECT_EQ(LaneMask{}.without(some), LaneMask{});
  EXPECT_EQ(some.without(some), LaneMask{});
}

/// A block of slots is cut into segments and shadow rays, and put together again.
TEST(LaneMask, PartsMakeTheWhole) {
  const LaneMask live = LaneMask::first(93);
  const LaneMask shadow = multiples_of(7);
  const LaneMask segments = live.without(shadow);
  EXPECT_EQ(segments.count(), 93 - 14);
  EXPECT_EQ(segments.with(live.without(segments)), live);
  EXPECT_FALSE(live.without(live.with(shadow)).any());
}

}  // namespace lane_mask_test
