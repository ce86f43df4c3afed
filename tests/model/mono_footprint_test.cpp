#include "model/hazards/mono_footprint.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace mono_footprint_test {

using cn::LaneMask;
using cn::MonoAddress;
using model::MonoFootprint;

constexpr int kPes = 16;

struct RandomTransfer {
  explicit RandomTransfer(std::mt19937& random) : addresses(kPes) {
    const auto pick = [&](int low, int high) {
      return std::uint64_t(std::uniform_int_distribution<int>(low, high)(random));
    };
    transfer.poly.size_bytes = int(8 * pick(1, 6));
    for (MonoAddress& address : addresses) address = 8 * pick(0, 120);
    transfer.mono = pick(0, 1) == 0 ? cn::MonoPlaces::array(8 * pick(0, 60), 8 * pick(0, 8))
                                    : cn::MonoPlaces::each(addresses.data(), 8 * pick(0, 9));
    for (int pe = 0; pe < kPes; ++pe) transfer.enabled.set(pe, pick(0, 3) == 0);
  }

  std::set<MonoAddress> bytes() const {
    std::set<MonoAddress> all;
    for (int pe = 0; pe < kPes; ++pe)
      for (int i = 0; transfer.enabled[pe] && i < transfer.poly.size_bytes; ++i)
        all.insert(transfer.mono[pe] + std::uint64_t(i));
    return all;
  }

  std::vector<MonoAddress> addresses;
  cn::Transfer transfer;
};

TEST(MonoFootprint, OverlapIsTheFirstByteThatBothTouch) {
  std::mt19937 random(5);
  int overlaps = 0;
  for (int round = 0; round < 5000; ++round) {
    const RandomTransfer a(random);
    const RandomTransfer b(random);
    const std::set<MonoAddress> of_b = b.bytes();
    std::optional<MonoAddress> expected;
    for (const MonoAddress byte : a.bytes()) {
      if (of_b.count(byte) == 0) continue;
      expected = byte;
      break;
    }
    const MonoFootprint footprint(b.transfer, kPes);
    const auto found = MonoFootprint(a.transfer, kPes).overlap(footprint);
    ASSERT_EQ(found.has_value(), expected.has_value()) << round;
    if (!found) continue;
    ++overlaps;
    EXPECT_EQ(found->first, *expected);
    for (std::uint64_t i = 0; i < found->bytes; ++i) EXPECT_EQ(of_b.count(found->first + i), 1u);
  }
  EXPECT_GT(overlaps, 1000);
  EXPECT_LT(overlaps, 4000);
}

TEST(MonoFootprint, ARangeIsOnePiece) {
  cn::Transfer transfer;
  transfer.poly.size_bytes = 8;
  transfer.mono = cn::MonoPlaces::array(100, 64);
  transfer.enabled = LaneMask::first(kPes);
  const MonoFootprint pieces(transfer, kPes);
  EXPECT_FALSE(MonoFootprint(model::MonoRange{108, 56}).overlap(pieces));
  EXPECT_EQ(MonoFootprint(model::MonoRange{108, 57}).overlap(pieces)->first, 164u);
  EXPECT_EQ(pieces.overlap(MonoFootprint(model::MonoRange{0, 1 << 20}))->bytes, 8u);
}

TEST(MonoFootprint, NobodyTouchesNothing) {
  cn::Transfer transfer;
  transfer.poly.size_bytes = 8;
  const MonoFootprint nothing(transfer, kPes);
  EXPECT_FALSE(nothing.overlap(MonoFootprint(model::MonoRange{0, 4096})));
  EXPECT_FALSE(nothing.overlap(nothing));
}

}  // namespace mono_footprint_test
