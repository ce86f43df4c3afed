#include "firmware/cn/language/indexed.hpp"

#include <cmath>
#include <cstring>
#include <random>

#include "firmware/cn/language/control.hpp"
#include "tests/support/number_samples.hpp"
#include "tests/support/poly_words.hpp"
#include "tests/support/strip_fixture.hpp"

namespace indexed_test {

using cn::InstructionClass;
using cn::LaneMask;
using cn::poly;
using test_support::counts;
using test_support::load;
using test_support::PerPe;
using test_support::same;
using test_support::store;

/// Poly memory full of random words, with random addresses; those of disabled PEs lead anywhere.
class CnIndexed : public test_support::StripFixture {
 protected:
  static constexpr int kPes = 64;
  static constexpr int kBytes = 1024;

  CnIndexed() : StripFixture(kPes) {
    for (int offset_bytes = 0; offset_bytes < kBytes; offset_bytes += 8)
      for (int pe = 0; pe < kPes; ++pe) memory.word(pe, offset_bytes) = random_();
  }

  LaneMask some_pes() {
    LaneMask enabled;
    for (int pe = 0; pe < kPes; ++pe) enabled.set(pe, random_() % 3 != 0);
    return enabled;
  }
  PerPe<std::int32_t> addresses(const LaneMask& enabled, int alignment) {
    PerPe<std::int32_t> addresses = per_pe<std::int32_t>();
    for (int pe = 0; pe < kPes; ++pe)
      addresses[std::size_t(pe)] = enabled[pe]
                                       ? std::int32_t(random_() % (kBytes / unsigned(alignment))) * alignment
                                       : static_cast<std::int32_t>(random_());
    return addresses;
  }
  /// Reads a value as each PE sees its own SRAM.
  template <class T>
  T at(int pe, std::int32_t address) const {
    const std::uint64_t word = memory.word(pe, address / 8 * 8);
    T value;
    std::memcpy(&value, reinterpret_cast<const char*>(&word) + address % 8, sizeof(T));
    return value;
  }

  template <class T>
  void expect_loads() {
    for (int round = 0; round < 50; ++round) {
      const LaneMask enabled = some_pes();
      const PerPe<std::int32_t> address = addresses(enabled, sizeof(T));
      PerPe<T> found = per_pe<T>();
      run(enabled, [&] { store(found, cn::load_at<T>(load(address))); });
      for (int pe = 0; pe < kPes; ++pe)
        if (enabled[pe]) {
          ASSERT_TRUE(same(found[std::size_t(pe)], at<T>(pe, address[std::size_t(pe)]))) << pe;
        }
    }
  }

  std::vector<std::uint64_t> all_words() const { return test_support::poly_words(memory, kBytes); }

  std::mt19937_64 random_{17};
};

TEST_F(CnIndexed, LoadsReadEachPesOwnPlace) {
  expect_loads<double>();
  expect_loads<std::uint64_t>();
  expect_loads<std::int64_t>();
  expect_loads<std::uint32_t>();
  expect_loads<std::int32_t>();
}

TEST_F(CnIndexed, StoresReachEachPesOwnPlaceAndNothingElse) {
  for (int round = 0; round < 50; ++round) {
    const LaneMask enabled = some_pes();
    const PerPe<std::int32_t> address = addresses(enabled, 8);
    PerPe<std::uint64_t> values = per_pe<std::uint64_t>();
    for (std::uint64_t& value : values) value = random_();
    std::vector<std::uint64_t> expected = all_words();
    for (int pe = 0; pe < kPes; ++pe)
      if (enabled[pe])
        expected[std::size_t(address[std::size_t(pe)] / 8 * kPes + pe)] = values[std::size_t(pe)];
    run(enabled, [&] { cn::store_at(load(address), load(values)); });
    ASSERT_EQ(all_words(), expected);
  }
}

/// Where a condition holds on some PEs only, the other PEs' addresses may be anything, too.
TEST_F(CnIndexed, ConditionsGuardAddresses) {
  const PerPe<std::int32_t> address = addresses(LaneMask::first(kPes / 2), 8);
  PerPe<std::uint64_t> doubled = per_pe<std::uint64_t>();
  const std::vector<std::uint64_t> before = all_words();
  run([&] {
    const poly<std::int32_t> where = load(address);
    poly<std::uint64_t> sum = 0u;
    cn::poly_if(cn::pe_num() < kPes / 2, [&] {
      sum = cn::load_at<std::uint64_t>(where);
      cn::store_at(where, sum + sum);
    });
    store(doubled, sum);
  });
  for (int pe = 0; pe < kPes; ++pe) {
    const bool takes_part = pe < kPes / 2;
    const auto word = takes_part ? std::size_t(address[std::size_t(pe)] / 8 * kPes + pe) : 0;
    ASSERT_EQ(doubled[std::size_t(pe)], takes_part ? before[word] : 0u);
    if (takes_part) {
      ASSERT_EQ(all_words()[word], 2 * before[word]);
    }
  }
  for (std::size_t word = 0; word < before.size(); ++word)
    if (word % kPes >= kPes / 2) {
      ASSERT_EQ(all_words()[word], before[word]);
    }
}

TEST_F(CnIndexed, AccessesCostWhatThoseAtOneAddressCost) {
  const PerPe<std::int32_t> zero = per_pe<std::int32_t>(0);
  const PerPe<std::uint64_t> words = per_pe<std::uint64_t>(0);
  EXPECT_EQ(issued_by([&] { cn::load_at<double>(load(zero)); }), counts({{InstructionClass::sram, 2}}));
  EXPECT_EQ(issued_by([&] { cn::load_at<std::int32_t>(load(zero)); }), counts({{InstructionClass::sram, 1}}));
  EXPECT_EQ(issued_by([&] { cn::store_at(load(zero), load(words)); }), counts({{InstructionClass::sram, 2}}));
}

TEST_F(CnIndexed, ShiftsTakeAnAmountFromEachPe) {
  PerPe<std::uint64_t> values = per_pe<std::uint64_t>();
  PerPe<std::int32_t> bits = per_pe<std::int32_t>();
  for (int pe = 0; pe < kPes; ++pe) {
    values[std::size_t(pe)] = random_();
    bits[std::size_t(pe)] = pe;  // 0 to 63
  }
  PerPe<std::uint64_t> left = per_pe<std::uint64_t>();
  PerPe<std::uint64_t> right = per_pe<std::uint64_t>();
  run([&] {
    store(left, cn::shift_left(load(values), load(bits)));
    store(right, cn::shift_right(load(values), load(bits)));
  });
  for (std::size_t pe = 0; pe < left.size(); ++pe) {
    EXPECT_EQ(left[pe], values[pe] << bits[pe]);
    EXPECT_EQ(right[pe], values[pe] >> bits[pe]);
  }
}

TEST_F(CnIndexed, TheHighestBitIsThatOfTheWholePart) {
  for (int bit = 0; bit < 32; ++bit) {
    PerPe<std::uint32_t> numbers = per_pe<std::uint32_t>();
    for (std::uint32_t& number : numbers)
      number = 1u << bit | (bit == 0 ? 0u : static_cast<std::uint32_t>(random_()) >> (32 - bit));
    numbers[0] = 1u << bit;
    numbers[1] = static_cast<std::uint32_t>((std::uint64_t{2} << bit) - 1);
    PerPe<std::int32_t> found = per_pe<std::int32_t>();
    run([&] { store(found, cn::highest_bit(load(numbers))); });
    EXPECT_EQ(found, per_pe(bit));
  }
}

}  // namespace indexed_test
