#include "firmware/cn/language/exact.hpp"

#include <cmath>
#include <cstring>
#include <random>

#include "tests/support/strip_fixture.hpp"

namespace exact_test {

using cn::poly;
using test_support::load;
using test_support::PerPe;
using test_support::store;

class CnExact : public test_support::StripFixture {
 protected:
  CnExact() : StripFixture(1024) {}

  /// Returns a number of any mantissa, between 2^-exponent and 2^exponent in size.
  PerPe<double> numbers(int exponent) {
    PerPe<double> numbers = per_pe<double>();
    std::uniform_real_distribution<double> mantissa(1.0, 2.0);
    std::uniform_int_distribution<int> power(-exponent, exponent);
    for (double& number : numbers)
      number = std::ldexp(random_() % 2 == 0 ? mantissa(random_) : -mantissa(random_), power(random_));
    return numbers;
  }

  std::mt19937_64 random_{23};
};

/// The processor's fused operation rounds once, and the rounding error of a product is a double.
TEST_F(CnExact, AProductsErrorIsWhatRoundingLeftOut) {
  int inexact = 0;
  for (const int exponent : {0, 1, 60, 400}) {
    for (int round = 0; round < 30; ++round) {
      const PerPe<double> a = numbers(exponent);
      const PerPe<double> b = numbers(exponent);
      PerPe<double> found = per_pe<double>();
      run([&] { store(found, cn::product_error(load(a), load(b), load(a) * load(b))); });
      for (std::size_t pe = 0; pe < found.size(); ++pe) {
        ASSERT_EQ(found[pe], std::fma(a[pe], b[pe], -(a[pe] * b[pe]))) << a[pe] << " * " << b[pe];
        inexact += found[pe] != 0;
      }
    }
  }
  EXPECT_GT(inexact, 100000);
}

TEST_F(CnExact, ProductsWithoutErrorHaveNone) {
  const PerPe<double> a = numbers(100);
  for (const double exact : {0.0, 1.0, -2.0, 0x1p-30, 0x1p400}) {
    PerPe<double> found = per_pe<double>(1.0);
    run([&] { store(found, cn::product_error(load(a), exact, load(a) * exact)); });
    EXPECT_EQ(found, per_pe(0.0)) << exact;
  }
}

TEST_F(CnExact, TheNearestPowerOfTwoIsWithinAFactorOfItsRoot) {
  const double root = std::sqrt(2.0) * (1 + 1e-15);
  for (int round = 0; round < 30; ++round) {
    PerPe<double> a = numbers(1000);
    for (double& number : a) number = std::abs(number);
    PerPe<double> found = per_pe<double>();
    run([&] { store(found, cn::nearest_power_of_two(load(a))); });
    for (std::size_t pe = 0; pe < a.size(); ++pe) {
      int exponent = 0;
      ASSERT_EQ(std::frexp(found[pe], &exponent), 0.5) << "no power of two: " << found[pe];
      ASSERT_LE(a[pe], found[pe] * root);
      ASSERT_GE(a[pe], found[pe] / root);
    }
  }
}

/// However a power of two is rounded, it stays the nearest.
TEST_F(CnExact, APowerOfTwoIsItsOwnNearestAndInvertedExactly) {
  for (int first = -1022; first <= 1022; first += num_pes()) {
    PerPe<double> powers = per_pe<double>(1.0);
    for (int i = 0; i < num_pes() && first + i <= 1022; ++i)
      powers[std::size_t(i)] = std::ldexp(1.0, first + i);
    for (const double rounded : {1.0, 1 - 1e-3, 1 + 1e-3}) {
      PerPe<double> nearest = per_pe<double>();
      PerPe<double> inverse = per_pe<double>();
      run([&] {
        const poly<double> power = cn::nearest_power_of_two(load(powers) * rounded);
        store(nearest, power);
        store(inverse, cn::inverse_power_of_two(power));
      });
      for (std::size_t pe = 0; pe < powers.size(); ++pe) {
        if (powers[pe] * rounded < 0x1p-1022) continue;
        ASSERT_EQ(nearest[pe], powers[pe]);
        ASSERT_EQ(inverse[pe], 1.0 / powers[pe]);
      }
    }
  }
}

TEST_F(CnExact, HalvesOfAWordAreItsBits) {
  PerPe<std::uint64_t> words = per_pe<std::uint64_t>();
  for (std::uint64_t& word : words) word = random_();
  const PerPe<double> doubles = numbers(900);
  PerPe<std::uint32_t> high = per_pe<std::uint32_t>();
  PerPe<std::uint32_t> low = per_pe<std::uint32_t>();
  PerPe<std::uint32_t> high_of_double = per_pe<std::uint32_t>();
  EXPECT_EQ(issued_by([&] {
              store(high, cn::high_word(load(words)));
              store(low, cn::low_word(load(words)));
              store(high_of_double, cn::high_word(load(doubles)));
            }),
            cn::IssueCounts{})
      << "naming half of a register costs nothing";
  for (std::size_t pe = 0; pe < words.size(); ++pe) {
    std::uint64_t bits;
    std::memcpy(&bits, &doubles[pe], sizeof(bits));
    EXPECT_EQ(high[pe], words[pe] >> 32);
    EXPECT_EQ(low[pe], words[pe] & 0xffffffffu);
    EXPECT_EQ(high_of_double[pe], bits >> 32);
  }
}

}  // namespace exact_test
