#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <vector>

#include "firmware/cn/chip/transfer.hpp"
#include "tests/support/poly_words.hpp"

namespace transfer_test {

using cn::Direction;
using cn::MonoAddress;
using cn::MonoPlaces;
using test_support::poly_words;

constexpr int kPes = 24;
constexpr int kPolyBytes = 512;
constexpr int kOffsetBytes = 16;
constexpr std::size_t kMonoBytes = 1 << 14;
constexpr MonoAddress kNowhere = ~MonoAddress{7};  // address of a disabled PE

/// Moves the data on a copy of both memories, PE by PE and word by word, and compares all of both memories
/// with the result of move_data.
class CnTransfer : public testing::Test {
 protected:
  CnTransfer() : poly(kPes, kPolyBytes), mono(kMonoBytes) {
    for (int i = 0; i < kPolyBytes / 8 * kPes; ++i) poly.words()[i] = random();
    for (std::uint8_t& byte : mono) byte = static_cast<std::uint8_t>(random());
  }

  void expect_move(Direction direction, int words, const MonoPlaces& places, const cn::LaneMask& enabled) {
    std::vector<std::uint64_t> expected_poly = poly_words(poly, kPolyBytes);
    std::vector<std::uint8_t> expected_mono = mono;
    for (int pe = 0; pe < kPes; ++pe) {
      if (!enabled[pe]) continue;
      for (int w = 0; w < words; ++w) {
        std::uint64_t* const word = &expected_poly[std::size_t((kOffsetBytes / 8 + w) * kPes + pe)];
        std::uint8_t* const place = &expected_mono[places[pe] + std::uint64_t(w) * 8];
        std::memcpy(direction == Direction::mono_to_poly ? static_cast<void*>(word) : place,
                    direction == Direction::mono_to_poly ? static_cast<void*>(place) : word, 8);
      }
    }
    cn::move_data({direction, {kOffsetBytes, words * 8}, places, enabled, {}}, poly, mono.data());
    ASSERT_EQ(poly_words(poly, kPolyBytes), expected_poly) << words;
    ASSERT_EQ(mono, expected_mono) << words;
  }

  /// Masks with full, empty and partly enabled strips.
  cn::LaneMask some_pes() {
    cn::LaneMask pes;
    for (int strip = 0; strip < kPes / cn::kStripLanes; ++strip)
      pes.set_strip_bits(strip, random() % 4 == 0 ? 0xff : random() & random() & 0xff);
    return pes;
  }

  std::mt19937_64 random{3};
  cn::PolyMemory poly;
  std::vector<std::uint8_t> mono;
};

TEST_F(CnTransfer, ArraysOfEveryLengthMoveWhole) {
  for (int words = 0; words <= 33; ++words)
    for (int round = 0; round < 8; ++round)
      for (const Direction direction : {Direction::mono_to_poly, Direction::poly_to_mono}) {
        const std::uint64_t stride = std::uint64_t(words) * 8 + random() % 3 * 8;
        expect_move(direction, words, MonoPlaces::array(random() % 64 * 8, stride),
                    round == 0 ? cn::LaneMask::first(kPes) : some_pes());
      }
}

TEST_F(CnTransfer, GathersOfEveryLengthMoveWholeAndDisabledPesMayPointAnywhere) {
  for (int words = 1; words <= 33; ++words)
    for (int round = 0; round < 8; ++round)
      for (const Direction direction : {Direction::mono_to_poly, Direction::poly_to_mono}) {
        const cn::LaneMask enabled = some_pes();
        std::vector<MonoAddress> addresses(kPes, kNowhere);
        for (int pe = 0; pe < kPes; ++pe)
          if (enabled[pe])
            addresses[std::size_t(pe)] = std::uint64_t(pe * 5 % kPes) * 40 * 8 + random() % 6 * 8;
        expect_move(direction, words, MonoPlaces::each(addresses.data(), 64), enabled);
      }
}

TEST_F(CnTransfer, OfPesThatSaveToTheSameWordTheHighestIsKept) {
  for (int words = 1; words <= 20; ++words)
    for (int round = 0; round < 20; ++round) {
      std::vector<MonoAddress> addresses;
      for (int pe = 0; pe < kPes; ++pe) addresses.push_back(random() % 40 * 8);
      expect_move(Direction::poly_to_mono, words, MonoPlaces::each(addresses.data(), 8),
                  round == 0 ? cn::LaneMask::first(kPes) : some_pes());
      expect_move(Direction::poly_to_mono, words, MonoPlaces::array(0, random() % 3 * 8), some_pes());
    }
}

/// A check of all PEs at a time against one of each PE.
void expect_within_as_pe_by_pe(const cn::Transfer& transfer, const cn::MonoRange& range) {
  bool all = true;
  for (int pe = 0; pe < kPes; ++pe)
    if (transfer.enabled[pe])
      all = all && range.contains(transfer.mono[pe], std::uint64_t(transfer.poly.size_bytes));
  EXPECT_EQ(lies_within(transfer, kPes, range), all) << range.first << " + " << range.bytes;
}

TEST(LiesWithin, HoldsIfEachEnabledPesPlaceDoes) {
  std::mt19937_64 random(5);
  const std::vector<cn::MonoRange> ranges{{0, 0}, {0, 4096}, {512, 4096}, {0, 16}, {1 << 20, 1 << 12}};
  const auto any_place = [&]() -> MonoAddress {
    if (random() % 64 == 0) return kNowhere - random() % 4096 / 8 * 8;
    return (random() % 16 == 0 ? 1 << 20 : 0) + random() % 5120 / 8 * 8;
  };
  int within = 0;
  for (int i = 0; i < 20000; ++i) {
    std::vector<MonoAddress> places(kPes);
    const MonoAddress middle = any_place();
    for (MonoAddress& place : places) place = random() % 2 == 0 ? any_place() : middle;
    cn::Transfer transfer;
    transfer.poly = {0, int(random() % 9) * 8};
    transfer.mono = random() % 2 == 0 ? MonoPlaces::each(places.data(), random() % 2 * 64)
                                      : MonoPlaces::array(any_place(), random() % 64 * 8);
    for (int pe = 0; pe < kPes; ++pe) transfer.enabled.set(pe, random() % 8 == 0);
    for (const cn::MonoRange& range : ranges) {
      expect_within_as_pe_by_pe(transfer, range);
      within += lies_within(transfer, kPes, range);
    }
  }
  EXPECT_GT(within, 2000);
}

}  // namespace transfer_test
