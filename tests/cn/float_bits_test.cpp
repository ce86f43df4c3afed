#include "firmware/cn/language/float_bits.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

#include "firmware/cn/language/exact.hpp"
#include "tests/support/number_samples.hpp"
#include "tests/support/strip_fixture.hpp"

namespace float_bits_test {

using cn::InstructionClass;
using cn::poly;
using test_support::counts;
using test_support::load;
using test_support::PerPe;
using test_support::store;

template <class To, class From>
To bits(From from) {
  static_assert(sizeof(To) == sizeof(From));
  To to;
  std::memcpy(&to, &from, sizeof(to));
  return to;
}

class CnFloatBits : public test_support::StripFixture {
 protected:
  CnFloatBits() : StripFixture(1024) {}

  /// Returns a float of any kind, among them NaN, infinities, zeros and denormals.
  PerPe<float> floats() {
    constexpr std::uint32_t kChosen[] = {0x00000000u, 0x80000000u, 0x00000001u, 0x807fffffu,
                                         0x3f800000u, 0x7f7fffffu, 0x7f800000u, 0xff800000u};
    PerPe<float> numbers = per_pe<float>();
    for (float& number : numbers)
      number = bits<float>(random_() % 4 == 0 ? kChosen[random_() % std::size(kChosen)]
                                              : static_cast<std::uint32_t>(random_()));
    return numbers;
  }
  PerPe<std::uint64_t> words() {
    PerPe<std::uint64_t> numbers = per_pe<std::uint64_t>();
    for (std::uint64_t& number : numbers) number = random_();
    return numbers;
  }
  /// Compares bits, because a NaN is not equal to itself.
  static void expect_bits(float found, std::uint32_t expected) {
    ASSERT_EQ(bits<std::uint32_t>(found), expected);
  }

  std::mt19937_64 random_{5};
};

TEST_F(CnFloatBits, HalvesOfAWordAreNamedWithoutAnInstruction) {
  const PerPe<std::uint64_t> words = this->words();
  PerPe<float> low = per_pe<float>();
  PerPe<float> high = per_pe<float>();
  PerPe<std::uint64_t> joined = per_pe<std::uint64_t>();
  const cn::IssueCounts issued = issued_by([&] {
    const poly<std::uint64_t> word = load(words);
    const poly<float> low_half = cn::low_float(word);
    const poly<float> high_half = cn::high_float(word);
    store(low, low_half);
    store(high, high_half);
    store(joined, cn::join_floats(low_half, high_half));
  });
  for (std::size_t pe = 0; pe < words.size(); ++pe) {
    expect_bits(low[pe], static_cast<std::uint32_t>(words[pe]));
    expect_bits(high[pe], static_cast<std::uint32_t>(words[pe] >> 32));
    ASSERT_EQ(joined[pe], words[pe]);
  }
  EXPECT_EQ(issued, cn::IssueCounts{});
}

TEST_F(CnFloatBits, AFloatIsJoinedToTheIntegerBelowIt) {
  const PerPe<float> high = floats();
  PerPe<std::uint32_t> low = per_pe<std::uint32_t>();
  for (std::uint32_t& number : low) number = static_cast<std::uint32_t>(random_());
  PerPe<std::uint64_t> joined = per_pe<std::uint64_t>();
  run([&] { store(joined, cn::join_words(load(high), load(low))); });
  for (std::size_t pe = 0; pe < low.size(); ++pe)
    ASSERT_EQ(joined[pe], std::uint64_t{bits<std::uint32_t>(high[pe])} << 32 | low[pe]);
}

TEST_F(CnFloatBits, BytesAreNumbers) {
  const PerPe<std::uint64_t> words = this->words();
  PerPe<float> bytes[4] = {per_pe<float>(), per_pe<float>(), per_pe<float>(), per_pe<float>()};
  PerPe<float> from_bits = per_pe<float>();
  run([&] {
    const poly<float> four = cn::high_float(load(words));
    store(bytes[0], cn::byte_of<0>(four));
    store(bytes[1], cn::byte_of<1>(four));
    store(bytes[2], cn::byte_of<2>(four));
    store(bytes[3], cn::byte_of<3>(four));
    store(from_bits, cn::float_of_bits(cn::high_word(load(words))));
  });
  for (std::size_t pe = 0; pe < words.size(); ++pe) {
    const auto four = static_cast<std::uint32_t>(words[pe] >> 32);
    for (int byte = 0; byte < 4; ++byte) ASSERT_EQ(bytes[byte][pe], float(four >> (8 * byte) & 0xffu));
    expect_bits(from_bits[pe], four);
  }
}

TEST_F(CnFloatBits, CompareAsSignedIntegers) {
  for (int round = 0; round < 20; ++round) {
    const PerPe<float> a = floats();
    const PerPe<float> b = floats();
    PerPe<float> least = per_pe<float>();
    PerPe<float> greatest = per_pe<float>();
    PerPe<char> at_most = per_pe<char>();
    run([&] {
      store(least, cn::min_by_bits(load(a), load(b)));
      store(greatest, cn::max_by_bits(load(a), load(b)));
      store(at_most, cn::at_most_by_bits(load(a), load(b)));
    });
    for (std::size_t pe = 0; pe < a.size(); ++pe) {
      const auto x = bits<std::int32_t>(a[pe]);
      const auto y = bits<std::int32_t>(b[pe]);
      expect_bits(least[pe], static_cast<std::uint32_t>(std::min(x, y)));
      expect_bits(greatest[pe], static_cast<std::uint32_t>(std::max(x, y)));
      ASSERT_EQ(bool(at_most[pe]), x <= y);
      if (!(a[pe] >= 0) || !(b[pe] >= 0) || std::signbit(a[pe]) || std::signbit(b[pe])) continue;
      ASSERT_EQ(least[pe], std::min(a[pe], b[pe]));
      ASSERT_EQ(bool(at_most[pe]), a[pe] <= b[pe]);
    }
  }
}

TEST_F(CnFloatBits, ComparingCostsTheIntegerUnit) {
  const auto chosen = counts({{InstructionClass::int32_alu, 1}, {InstructionClass::move, 1}});
  const poly<float> a = 1.0f;
  const poly<float> b = 2.0f;
  EXPECT_EQ(issued_by([&] { cn::min_by_bits(a, b); }), chosen);
  EXPECT_EQ(issued_by([&] { cn::max_by_bits(a, b); }), chosen);
  EXPECT_EQ(issued_by([&] { cn::at_most_by_bits(a, b); }), counts({{InstructionClass::int32_alu, 1}}));
  const auto byte = [](std::uint64_t steps) {
    return counts({{InstructionClass::int32_alu, steps}, {InstructionClass::convert, 1}});
  };
  EXPECT_EQ(issued_by([&] { cn::byte_of<0>(a); }), byte(1));
  EXPECT_EQ(issued_by([&] { cn::byte_of<2>(a); }), byte(2));
  EXPECT_EQ(issued_by([&] { cn::byte_of<3>(a); }), byte(1));
}

/// The words include denormals and the largest double.
TEST_F(CnFloatBits, WordsOfFiniteDoublesArePutInOrder) {
  constexpr std::uint64_t kLargest = 0x7fefffffffffffffu;
  constexpr std::uint64_t kChosen[] = {0, 1, 0x000fffffffffffffu, 0x7f800000ffffffffu, kLargest};
  const auto words_of_doubles = [&] {
    PerPe<std::uint64_t> numbers = words();
    for (std::uint64_t& number : numbers) {
      number = random_() % 4 == 0 ? kChosen[random_() % std::size(kChosen)] : number & 0x7fffffffffffffffu;
      number = std::min(number, kLargest);
    }
    return numbers;
  };
  const PerPe<std::uint64_t> a = words_of_doubles();
  PerPe<std::uint64_t> b = words_of_doubles();
  for (std::size_t pe = 0; pe < b.size(); pe += 5) b[pe] = a[pe];
  PerPe<std::uint64_t> first = per_pe<std::uint64_t>();
  PerPe<std::uint64_t> second = per_pe<std::uint64_t>();
  const cn::IssueCounts issued = issued_by([&] {
    poly<std::uint64_t> x = load(a);
    poly<std::uint64_t> y = load(b);
    cn::put_in_order(x, y);
    store(first, x);
    store(second, y);
  });
  for (std::size_t pe = 0; pe < a.size(); ++pe) {
    ASSERT_EQ(first[pe], std::min(a[pe], b[pe]));
    ASSERT_EQ(second[pe], std::max(a[pe], b[pe]));
  }
  EXPECT_EQ(issued, counts({{InstructionClass::int64_alu, 1}, {InstructionClass::move, 2}}));
}

}  // namespace float_bits_test
