#include <cmath>
#include <limits>
#include <random>

#include "firmware/cn/language/poly.hpp"
#include "tests/support/number_samples.hpp"
#include "tests/support/strip_fixture.hpp"

namespace conversion_test {

using cn::InstructionClass;
using cn::mask;
using test_support::counts;
using test_support::fill_pairs;
using test_support::load;
using test_support::PerPe;
using test_support::same;
using test_support::store;

class CnConversion : public test_support::StripFixture {
 protected:
  CnConversion() : StripFixture(1024) {}

  /// Values of From that To can hold; an integer To holds any integer, as it wraps.
  template <class To, class From>
  void expect_converts() {
    PerPe<From> from = per_pe<From>();
    PerPe<From> unused = per_pe<From>();
    fill_pairs(unused, from);
    if constexpr (std::is_floating_point_v<From> && std::is_integral_v<To>) {
      std::mt19937_64 random(5);
      for (From& value : from) value = in_range<To, From>(random);
    }
    PerPe<To> found = per_pe<To>();
    EXPECT_EQ(issued_by([&] { store(found, cn::convert<To>(load(from))); }),
              counts({{InstructionClass::convert, 1}}));
    for (std::size_t i = 0; i < from.size(); ++i)
      if (!same(found[i], static_cast<To>(from[i]))) ADD_FAILURE() << from[i] << " became " << found[i];
  }

  template <class To, class From>
  static From in_range(std::mt19937_64& random) {
    using Limits = std::numeric_limits<To>;
    constexpr int kBits = Limits::digits;
    const double magnitude =
        std::ldexp(static_cast<double>(random() >> 11) * 0x1p-53, static_cast<int>(random() % (kBits + 1)));
    const auto value = static_cast<From>(std::is_signed_v<To> && random() % 2 ? -magnitude : magnitude);
    return value < std::ldexp(From(1), kBits) ? value : From(0);
  }

  template <class From>
  void expect_converts_to_all() {
    expect_converts<double, From>();
    expect_converts<float, From>();
    expect_converts<std::int16_t, From>();
    expect_converts<std::int32_t, From>();
    expect_converts<std::uint32_t, From>();
    expect_converts<std::int64_t, From>();
    expect_converts<std::uint64_t, From>();
  }
};

TEST_F(CnConversion, ConvertsBetweenAllFormats) {
  expect_converts_to_all<double>();
  expect_converts_to_all<float>();
  expect_converts_to_all<std::int16_t>();
  expect_converts_to_all<std::int32_t>();
  expect_converts_to_all<std::uint32_t>();
  expect_converts_to_all<std::int64_t>();
  expect_converts_to_all<std::uint64_t>();
}

/// C++ and the x86-64 levels leave this undefined; a PE's result must not depend on the processor that
/// simulates it.
TEST_F(CnConversion, NumbersOutOfRangeGiveTheSameBitsAtEveryLevel) {
  const std::vector<std::pair<double, std::uint32_t>> known{{-1.5, 0xffffffffu},
                                                            {-2.0, 0xfffffffeu},
                                                            {5e9, 0x2a05f200u},
                                                            {-3e9, 0x4d2fa200u},
                                                            {1e30, 0u},
                                                            {-1e30, 0u},
                                                            {std::numeric_limits<double>::quiet_NaN(), 0u}};
  PerPe<double> from = per_pe<double>();
  for (std::size_t i = 0; i < known.size(); ++i) from[i] = known[i].first;
  PerPe<std::uint32_t> unsigned_words = per_pe<std::uint32_t>();
  PerPe<std::int32_t> signed_words = per_pe<std::int32_t>();
  PerPe<std::int16_t> half_words = per_pe<std::int16_t>();
  run([&] {
    store(unsigned_words, cn::convert<std::uint32_t>(load(from)));
    store(signed_words, cn::convert<std::int32_t>(load(from)));
    store(half_words, cn::convert<std::int16_t>(load(from)));
  });
  for (std::size_t i = 0; i < known.size(); ++i) {
    EXPECT_EQ(unsigned_words[i], known[i].second) << known[i].first;
    EXPECT_EQ(signed_words[i], static_cast<std::int32_t>(known[i].second)) << known[i].first;
    EXPECT_EQ(half_words[i], static_cast<std::int16_t>(known[i].second)) << known[i].first;
  }
}

TEST_F(CnConversion, ReinterpretsBitsForFree) {
  PerPe<double> doubles = per_pe<double>();
  PerPe<std::int32_t> words = per_pe<std::int32_t>();
  PerPe<double> unused = doubles;
  PerPe<std::int32_t> unused_words = words;
  fill_pairs(unused, doubles);
  fill_pairs(unused_words, words);
  PerPe<std::int64_t> bits = per_pe<std::int64_t>();
  PerPe<double> back = per_pe<double>();
  PerPe<std::uint32_t> unsigned_words = per_pe<std::uint32_t>();
  PerPe<std::int32_t> signed_words = per_pe<std::int32_t>();
  const cn::IssueCounts counted = issued_by([&] {
    store(bits, cn::reinterpret<std::int64_t>(load(doubles)));
    store(back, cn::reinterpret<double>(load(bits)));
    store(unsigned_words, cn::reinterpret_word<std::uint32_t>(load(words)));
    store(signed_words, cn::reinterpret_word<std::int32_t>(load(unsigned_words)));
  });
  EXPECT_EQ(counted, counts({}));
  for (std::size_t i = 0; i < doubles.size(); ++i) {
    EXPECT_EQ(std::memcmp(&bits[i], &doubles[i], sizeof(double)), 0);
    EXPECT_TRUE(same(back[i], doubles[i]));
    EXPECT_EQ(unsigned_words[i], static_cast<std::uint32_t>(words[i]));
    EXPECT_EQ(signed_words[i], words[i]);
  }
}

TEST_F(CnConversion, MultipliesTo64Bits) {
  PerPe<std::uint32_t> a = per_pe<std::uint32_t>();
  PerPe<std::uint32_t> unused = a;
  fill_pairs(unused, a);
  PerPe<std::uint32_t> high = a;
  PerPe<std::uint32_t> low = a;
  PerPe<std::uint64_t> joined = per_pe<std::uint64_t>();
  for (const std::uint32_t b : {0u, 1u, 80u, 0x80000000u, 0xD2511F53u, 0xffffffffu}) {
    const cn::IssueCounts counted = issued_by([&] {
      const cn::WideProduct product = cn::multiply_wide(load(a), b);
      store(high, product.high);
      store(low, product.low);
      store(joined, cn::join_words(product));
    });
    EXPECT_EQ(counted, counts({{InstructionClass::int32_mul, 1}}));
    for (std::size_t i = 0; i < a.size(); ++i) {
      const std::uint64_t product = std::uint64_t{a[i]} * b;
      EXPECT_EQ(high[i], product >> 32);
      EXPECT_EQ(low[i], product & 0xffffffffu);
      EXPECT_EQ(joined[i], product);
    }
  }
}

TEST_F(CnConversion, EveryPeKnowsItsNumber) {
  PerPe<std::int32_t> numbers = per_pe<std::int32_t>();
  EXPECT_EQ(issued_by([&] { store(numbers, cn::pe_num()); }), counts({{InstructionClass::sram, 1}}));
  for (int pe = 0; pe < num_pes(); ++pe) EXPECT_EQ(numbers[std::size_t(pe)], pe);
  run([&] { EXPECT_EQ(cn::num_pes(), num_pes()); });
}

TEST_F(CnConversion, MasksCombine) {
  PerPe<char> both = per_pe<char>();
  PerPe<char> either = both;
  PerPe<char> neither = both;
  run([&] {
    const mask low = cn::pe_num() < 600;
    const mask high = cn::pe_num() >= 400;
    store(both, low & high);
    store(either, low | !high);
    store(neither, !low);
  });
  for (int pe = 0; pe < num_pes(); ++pe) {
    EXPECT_EQ(bool(both[std::size_t(pe)]), pe < 600 && pe >= 400);
    EXPECT_EQ(bool(either[std::size_t(pe)]), pe < 600 || !(pe >= 400));
    EXPECT_EQ(bool(neither[std::size_t(pe)]), pe >= 600);
  }
  const mask none = mask(cn::MaskLanes{});
  for (const auto& counted :
       {issued_by([&] { none& none; }), issued_by([&] { none | none; }), issued_by([&] { !none; })})
    EXPECT_EQ(counted, counts({{InstructionClass::int16_alu, 1}}));
}

}  // namespace conversion_test
