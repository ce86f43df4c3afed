#include "firmware/path_tracer/sampling/sobol.hpp"

#include <cmath>
#include <random>
#include <set>

#include "tests/support/chi_square.hpp"
#include "tests/support/number_samples.hpp"
#include "tests/support/strip_fixture.hpp"

namespace sobol_test {

using cn::InstructionClass;
using path_tracer::Purpose;
using test_support::ChiSquare;
using test_support::load;
using test_support::PerPe;
using test_support::store;

std::uint32_t reversed(std::uint32_t a) {
  std::uint32_t result = 0;
  for (int bit = 0; bit < 32; ++bit) result |= ((a >> bit) & 1u) << (31 - bit);
  return result;
}

class Sobol : public test_support::StripFixture {
 protected:
  static constexpr int kPoints = 1024;
  Sobol() : StripFixture(kPoints) {}

  struct Points {
    PerPe<double> u;
    PerPe<double> v;
    PerPe<double> single;
  };
  /// One point for each PE: sample numbers first_sample, first_sample + 1, ...
  Points points(std::uint64_t seed, int pixel, int depth, Purpose purpose, int first_sample = 0) {
    PerPe<std::int32_t> sample = per_pe<std::int32_t>();
    for (std::size_t i = 0; i < sample.size(); ++i) sample[i] = first_sample + static_cast<int>(i);
    Points result{per_pe<double>(), per_pe<double>(), per_pe<double>()};
    run([&] {
      const auto point = path_tracer::sobol_point(seed, pixel, load(sample), depth, purpose);
      const auto pair = path_tracer::sobol_pair(point);
      store(result.u, pair.u);
      store(result.v, pair.v);
      store(result.single, path_tracer::sobol_single(point));
    });
    return result;
  }
};

TEST_F(Sobol, ReversesBits) {
  std::mt19937_64 random(3);
  PerPe<std::uint32_t> words = per_pe<std::uint32_t>();
  for (auto& word : words) word = static_cast<std::uint32_t>(random());
  for (std::size_t bit = 0; bit < 32; ++bit) words[bit] = 1u << bit;
  words[32] = 0;
  words[33] = 0xffffffffu;
  PerPe<std::uint32_t> found = per_pe<std::uint32_t>();
  run([&] { store(found, cn::reverse_bits(load(words))); });
  for (std::size_t i = 0; i < words.size(); ++i) EXPECT_EQ(found[i], reversed(words[i])) << words[i];
}

/// The direction numbers of dimension 2 as the literature makes them (Bratley and Fox 1988; primitive
/// polynomial x + 1): v[k] = v[k-1] ^ (v[k-1] >> 1).
TEST_F(Sobol, SecondCoordinateEqualsDirectionNumbers) {
  std::uint32_t direction[32];
  direction[0] = 0x80000000u;
  for (int k = 1; k < 32; ++k) direction[k] = direction[k - 1] ^ (direction[k - 1] >> 1);
  std::mt19937_64 random(5);
  PerPe<std::uint32_t> numbers = per_pe<std::uint32_t>();
  for (std::size_t i = 0; i < numbers.size(); ++i)
    numbers[i] = i < 512 ? static_cast<std::uint32_t>(i) : static_cast<std::uint32_t>(random());
  PerPe<std::uint32_t> found = per_pe<std::uint32_t>();
  run([&] { store(found, path_tracer::sobol_second_reversed(load(numbers))); });
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    std::uint32_t expected = 0;
    for (int k = 0; k < 32; ++k)
      if ((numbers[i] >> k & 1u) != 0) expected ^= direction[k];
    EXPECT_EQ(reversed(found[i]), expected) << numbers[i];
  }
}

/// Nested: two numbers that agree in their first bits still do, and all scramblings are permutations.
TEST_F(Sobol, ScramblingKeepsElementaryIntervals) {
  for (const std::uint32_t seed : {0u, 1u, 0x9e3779b9u, 0xffffffffu}) {
    PerPe<std::uint32_t> words = per_pe<std::uint32_t>();
    for (std::size_t i = 0; i < words.size(); ++i) words[i] = static_cast<std::uint32_t>(i);
    PerPe<std::uint32_t> found = words;
    run([&] { store(found, path_tracer::scramble_reversed(load(words), seed)); });
    for (int bits = 1; bits <= 10; ++bits) {
      const std::uint32_t low = (1u << bits) - 1;
      std::vector<std::set<std::uint32_t>> images(std::size_t(low) + 1);
      for (std::size_t i = 0; i < words.size(); ++i) images[words[i] & low].insert(found[i] & low);
      std::set<std::uint32_t> all;
      for (const auto& image : images) {
        ASSERT_EQ(image.size(), 1u);
        all.insert(*image.begin());
      }
      EXPECT_EQ(all.size(), images.size());
    }
  }
}

/// Every aligned run of 2^m samples has one point in each of the 2^m boxes of any shape of that area.
TEST_F(Sobol, SamplesOfAPixelAreANet) {
  for (const int pixel : {0, 7, 230399}) {
    for (const int first : {0, 1024, 65536}) {
      const Points p = points(1, pixel, 2, Purpose::scatter, first);
      for (int m = 0; m <= 10; ++m) {
        for (int rows = 0; rows <= m; ++rows) {
          const double columns = std::ldexp(1.0, m - rows);
          const double row_count = std::ldexp(1.0, rows);
          for (std::size_t begin = 0; begin < p.u.size(); begin += std::size_t(1) << m) {
            std::set<std::pair<int, int>> boxes;
            for (std::size_t i = begin; i < begin + (std::size_t(1) << m); ++i)
              boxes.insert({int(p.u[i] * columns), int(p.v[i] * row_count)});
            ASSERT_EQ(boxes.size(), std::size_t(1) << m) << "pixel " << pixel << " rows " << rows;
          }
        }
        std::set<int> strata;
        for (std::size_t i = 0; i < std::size_t(1) << m; ++i)
          strata.insert(int(p.single[i] * std::ldexp(1.0, m)));
        ASSERT_EQ(strata.size(), std::size_t(1) << m);
      }
    }
  }
}

/// One sample of many pixels, purposes and depths: each point is uniform by itself, which makes every
/// estimate unbiased.
TEST_F(Sobol, EachPointIsUniformOverPixels) {
  for (const int sample : {0, 1, 5, 1023}) {
    for (const Purpose purpose : {Purpose::camera, Purpose::scatter, Purpose::light}) {
      ChiSquare pairs = ChiSquare::uniform(16 * 16);
      ChiSquare with_single = ChiSquare::uniform(16 * 16);
      for (int round = 0; round < 64; ++round) {
        PerPe<std::int32_t> pixel = per_pe<std::int32_t>();
        for (std::size_t i = 0; i < pixel.size(); ++i) pixel[i] = round * num_pes() + static_cast<int>(i);
        PerPe<double> u = per_pe<double>();
        PerPe<double> v = u;
        PerPe<double> single = u;
        run([&] {
          const auto point = path_tracer::sobol_point(9, load(pixel), sample, 1, purpose);
          const auto pair = path_tracer::sobol_pair(point);
          store(u, pair.u);
          store(v, pair.v);
          store(single, path_tracer::sobol_single(point));
        });
        for (std::size_t i = 0; i < u.size(); ++i) {
          const auto cell = [](double a, double b) {
            return static_cast<std::size_t>(a * 16) * 16 + static_cast<std::size_t>(b * 16);
          };
          pairs.add(cell(u[i], v[i]));
          with_single.add(cell(u[i], single[i]));
        }
      }
      EXPECT_LT(std::abs(pairs.deviation()), 4.5) << sample;
      EXPECT_LT(std::abs(with_single.deviation()), 4.5) << sample;
    }
  }
}

double correlation(const PerPe<double>& a, const PerPe<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - 0.5) * (b[i] - 0.5) * 12.0;
  return sum / std::sqrt(static_cast<double>(a.size()));
}

TEST_F(Sobol, DimensionsSeedsPixelsDepthsAndPurposesAreShuffledApart) {
  std::vector<PerPe<double>> streams;
  const auto add = [&](const Points& p) {
    streams.push_back(p.u);
    streams.push_back(p.v);
    streams.push_back(p.single);
  };
  add(points(1, 0, 0, Purpose::camera));
  add(points(1, 0, 0, Purpose::scatter));
  add(points(1, 0, 0, Purpose::light));
  add(points(1, 0, 1, Purpose::scatter));
  add(points(1, 1, 0, Purpose::scatter));
  add(points(2, 0, 0, Purpose::scatter));
  add(points(std::uint64_t{1} << 32, 0, 0, Purpose::scatter));
  for (std::size_t i = 0; i < streams.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      EXPECT_LT(std::abs(correlation(streams[i], streams[j])), 4.5) << i << " " << j;
}

/// The error of a smooth integral falls faster than 1 / samples; independent numbers give 1 / sqrt(samples).
TEST_F(Sobol, IntegratesSmoothFunctionsFast) {
  const auto error = [&](int count) {
    double squares = 0;
    constexpr int kPixels = 64;
    for (int pixel = 0; pixel < kPixels; ++pixel) {
      const Points p = points(4, pixel, 0, Purpose::scatter);
      double sum = 0;
      for (std::size_t i = 0; i < std::size_t(count); ++i) sum += p.u[i] * p.u[i] * std::exp(p.v[i]);
      const double difference = sum / count - (std::exp(1.0) - 1) / 3;
      squares += difference * difference;
    }
    return std::sqrt(squares / kPixels);
  };
  const double slope = std::log(error(1024) / error(16)) / std::log(1024.0 / 16);
  EXPECT_LT(slope, -1.2);
}

TEST_F(Sobol, CostOfAPair) {
  const cn::IssueCounts issued =
      issued_by([] { path_tracer::sobol_pair(path_tracer::sobol_point(7, 1, 2, 3, Purpose::light)); });
  // Scrambling words: 7 rounds. Four reversals, three scramblings of 4 products, five steps of Pascal's
  // triangle.
  EXPECT_EQ(issued, test_support::counts({{InstructionClass::int32_mul, 2 * 7 + 3 * 4},
                                          {InstructionClass::int32_alu, 4 * 7 + 4 * 20 + 3 * 5 + 5 * 3},
                                          {InstructionClass::convert, 2},
                                          {InstructionClass::fp64_add, 2},
                                          {InstructionClass::fp64_mul, 2}}));
}

}  // namespace sobol_test
