#include "model/transaction/mono_pieces.hpp"

#include <gtest/gtest.h>

namespace mono_pieces_test {

using cn::Direction;
using cn::LaneMask;
using cn::MonoAddress;
using cn::MonoPlaces;
using model::MonoPieces;

constexpr int kPes = 16;
const MonoPieces::Rules kRules{model::Divisor(64), false};
const MonoPieces::Rules kConsolidating{model::Divisor(64), true};

MonoPieces describe(const MonoPlaces& places, int bytes, const LaneMask& enabled,
                    const MonoPieces::Rules& rules = kRules, Direction direction = Direction::mono_to_poly) {
  MonoPieces pieces;
  pieces.describe({direction, {0, bytes}, places, enabled, {0}}, kPes, rules);
  return pieces;
}

void expect_runs(const MonoPieces& pieces, const std::vector<MonoPieces::Run>& expected) {
  ASSERT_EQ(pieces.runs().size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(pieces.runs()[i].address, expected[i].address) << i;
    EXPECT_EQ(pieces.runs()[i].bytes, expected[i].bytes) << i;
  }
}

TEST(MonoPieces, GaplessArrayIsOneRun) {
  const auto pieces = describe(MonoPlaces::array(0x1000, 80), 80, LaneMask::first(kPes));
  expect_runs(pieces, {{0x1000, 1280}});
  EXPECT_EQ(pieces.pes(), 16);
  EXPECT_EQ(pieces.pieces(), 16);
  EXPECT_EQ(pieces.packets(), 20u);
  EXPECT_EQ(pieces.misaligned(), 0);  // no piece touches more than the two packets that it needs
  EXPECT_EQ(pieces.poly_bytes(), 1280u);
}

TEST(MonoPieces, GaplessArrayCountsPiecesAcrossPackets) {
  EXPECT_EQ(describe(MonoPlaces::array(0, 32), 32, LaneMask::first(kPes)).misaligned(), 0);
  EXPECT_EQ(describe(MonoPlaces::array(16, 32), 32, LaneMask::first(kPes)).misaligned(), 8);
  EXPECT_EQ(describe(MonoPlaces::array(0, 48), 48, LaneMask::first(kPes)).misaligned(), 8);
  EXPECT_EQ(describe(MonoPlaces::array(0, 64), 64, LaneMask::first(kPes)).misaligned(), 0);
  EXPECT_EQ(describe(MonoPlaces::array(4, 8), 8, LaneMask::first(kPes)).misaligned(), 16);
}

TEST(MonoPieces, LongPieceIsMisalignedWhereItTouchesAPacketMore) {
  EXPECT_EQ(describe(MonoPlaces::array(56, 80), 80, LaneMask::first(1)).misaligned(), 1);  // 56..135
  // Offsets 8, 24, 40, 56 in turn; the last of the four.
  EXPECT_EQ(describe(MonoPlaces::array(8, 80), 80, LaneMask::first(kPes)).misaligned(), 4);
  EXPECT_EQ(describe(MonoPlaces::array(8, 80), 80, LaneMask::first(7)).misaligned(), 1);
  EXPECT_EQ(describe(MonoPlaces::array(8, 128), 128, LaneMask::first(kPes)).misaligned(), 16);
}

TEST(MonoPieces, ArrayAndEqualTableCountAlike) {
  for (const std::uint64_t first : {0, 4, 8, 24, 56, 60}) {
    for (const int bytes : {8, 24, 40, 48, 64, 80, 104, 128, 200}) {
      MonoAddress by_pe[kPes];
      for (int pe = 0; pe < kPes; ++pe) by_pe[pe] = first + std::uint64_t(pe * bytes);
      const auto table = describe(MonoPlaces::each(by_pe), bytes, LaneMask::first(kPes));
      const auto array =
          describe(MonoPlaces::array(first, std::uint64_t(bytes)), bytes, LaneMask::first(kPes));
      EXPECT_EQ(table.misaligned(), array.misaligned()) << bytes << " bytes at " << first;
      EXPECT_EQ(table.runs().size(), 1u);
    }
  }
}

TEST(MonoPieces, HolesInTheMaskSplitRuns) {
  LaneMask enabled = LaneMask::first(5);
  enabled.set(2, false);
  enabled.set(11, true);
  const auto pieces = describe(MonoPlaces::array(0, 32), 32, enabled);
  expect_runs(pieces, {{0, 64}, {96, 64}, {352, 32}});
  EXPECT_EQ(pieces.pes(), 5);
  EXPECT_EQ(pieces.packets(), 3u);
}

TEST(MonoPieces, ContiguousRangeInTheMiddleIsOneRun) {
  LaneMask enabled;
  for (int pe = 6; pe < 11; ++pe) enabled.set(pe, true);
  expect_runs(describe(MonoPlaces::array(0, 32), 32, enabled), {{192, 160}});
}

TEST(MonoPieces, StrideWithGapsIsARunAPiece) {
  const auto pieces = describe(MonoPlaces::array(8, 128), 64, LaneMask::first(3));
  expect_runs(pieces, {{8, 64}, {136, 64}, {264, 64}});
  EXPECT_EQ(pieces.misaligned(), 3);
}

TEST(MonoPieces, GatherMergesNeighboursInPeOrderOnly) {
  const MonoAddress by_pe[kPes] = {64, 96, 32, 0, 200, 232};
  const auto pieces = describe(MonoPlaces::each(by_pe), 32, LaneMask::first(6));
  expect_runs(pieces, {{64, 64}, {32, 32}, {0, 32}, {200, 64}});
  EXPECT_EQ(pieces.misaligned(), 1);  // 232..263
}

TEST(MonoPieces, AddressesAreCopied) {
  MonoAddress by_pe[kPes] = {640, 64};
  const auto pieces = describe(MonoPlaces::each(by_pe), 8, LaneMask::first(2));
  by_pe[0] = 0;
  EXPECT_EQ(pieces.places()[0], 640u);
  EXPECT_EQ(pieces.places()[1], 64u);
}

TEST(MonoPieces, EqualAddressesOfAReadAreFetchedOnce) {
  const MonoAddress by_pe[kPes] = {512, 0, 512, 64, 0, 512};
  const auto pieces = describe(MonoPlaces::each(by_pe), 64, LaneMask::first(6), kConsolidating);
  expect_runs(pieces, {{512, 64}, {0, 128}});
  EXPECT_EQ(pieces.pes(), 6);
  EXPECT_EQ(pieces.pieces(), 3);
  EXPECT_EQ(pieces.poly_bytes(), 384u);
  EXPECT_EQ(pieces.mono_bytes(), 192u);
}

TEST(MonoPieces, ConsolidationStartsAfreshWithEachRequest) {
  MonoPieces pieces;
  for (int repeat = 0; repeat < 3; ++repeat) {
    pieces.describe({Direction::mono_to_poly, {0, 8}, MonoPlaces::array(0, 0), LaneMask::first(kPes), {0}},
                    kPes, kConsolidating);
    EXPECT_EQ(pieces.pieces(), 1);
    expect_runs(pieces, {{0, 8}});
  }
}

TEST(MonoPieces, WritesAndPlainGathersAreNeverConsolidated) {
  const MonoPlaces same = MonoPlaces::array(64, 0);
  EXPECT_EQ(describe(same, 64, LaneMask::first(4)).pieces(), 4);
  EXPECT_EQ(describe(same, 64, LaneMask::first(4), kConsolidating, Direction::poly_to_mono).pieces(), 4);
}

}  // namespace mono_pieces_test
