#include "firmware/path_tracer/sampling/random.hpp"

#include <Random123/philox.h>

#include <array>
#include <random>

#include "tests/support/chi_square.hpp"
#include "tests/support/number_samples.hpp"
#include "tests/support/strip_fixture.hpp"

namespace random_test {

using cn::InstructionClass;
using path_tracer::Purpose;
using path_tracer::uniform4;
using test_support::ChiSquare;
using test_support::load;
using test_support::PerPe;
using test_support::store;

using Words = std::array<std::uint32_t, 4>;
using Draws = std::array<PerPe<double>, 4>;

class Random : public test_support::StripFixture {
 protected:
  Random() : StripFixture(1024) {}

  Draws draw(std::uint64_t seed, const PerPe<std::int32_t>& pixel, const PerPe<std::int32_t>& sample,
             const PerPe<std::int32_t>& depth, Purpose purpose) {
    Draws draws;
    draws.fill(per_pe<double>());
    run([&] {
      const path_tracer::Uniform4 random = uniform4(seed, load(pixel), load(sample), load(depth), purpose);
      for (std::size_t i = 0; i < 4; ++i) store(draws[i], random.value[i]);
    });
    return draws;
  }

  /// Visits all samples, 0 to 255, of 1024 neighbouring pixels.
  template <class Visit>  // (const Draws&, sample) -> void
  void for_each_draw(std::uint64_t seed, int depth, Purpose purpose, Visit&& visit) {
    PerPe<std::int32_t> pixel = per_pe<std::int32_t>();
    for (int pe = 0; pe < num_pes(); ++pe) pixel[std::size_t(pe)] = pe;
    for (int sample = 0; sample < 256; ++sample)
      visit(draw(seed, pixel, per_pe(sample), per_pe(depth), purpose), sample);
  }

  /// Returns the 32 random bits behind a uniform number.
  static std::uint32_t word_of(double uniform) {
    const double word = uniform * 4294967296.0 - 0.5;
    EXPECT_EQ(word, std::floor(word));
    EXPECT_TRUE(word >= 0 && word < 4294967296.0) << word;
    return static_cast<std::uint32_t>(word);
  }
};

Words philox(const Words& counter, std::uint64_t seed) {
  const r123::Philox4x32::ctr_type ctr = {{counter[0], counter[1], counter[2], counter[3]}};
  const r123::Philox4x32::key_type key = {
      {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)}};
  const auto result = r123::Philox4x32()(ctr, key);
  return {result[0], result[1], result[2], result[3]};
}

TEST_F(Random, GivesTheKnownAnswersOfPhilox) {
  struct Known {
    Words counter;
    std::uint64_t seed;
    Words answer;
  };
  // Random123 1.14, its file kat_vectors, philox4x32 with 10 rounds.
  const Known known[] = {
      {{0, 0, 0, 0}, 0, {0x6627e8d5u, 0xe169c58du, 0xbc57ac4cu, 0x9b00dbd8u}},
      {{0xffffffffu, 0xffffffffu, 0xffffffffu, 0xffffffffu},
       0xffffffffffffffffu,
       {0x408f276du, 0x41c83b0eu, 0xa20bc7c6u, 0x6d5451fdu}},
      {{0x243f6a88u, 0x85a308d3u, 0x13198a2eu, 0x03707344u},
       0x299f31d0a4093822u,
       {0xd16cfe09u, 0x94fdccebu, 0x5001e420u, 0x24126ea1u}},
  };
  for (const Known& k : known) {
    EXPECT_EQ(philox(k.counter, k.seed), k.answer);
    const auto word = [&](std::size_t i) { return per_pe(static_cast<std::int32_t>(k.counter[i])); };
    const Draws draws = draw(k.seed, word(0), word(1), word(2), static_cast<Purpose>(k.counter[3]));
    for (std::size_t i = 0; i < 4; ++i)
      for (const double uniform : draws[i]) ASSERT_EQ(word_of(uniform), k.answer[i]);
  }
}

TEST_F(Random, EqualsPhiloxForAnyCounterAndSeed) {
  std::mt19937_64 random(13);
  const auto words = [&] {
    PerPe<std::int32_t> values = per_pe<std::int32_t>();
    for (auto& value : values) value = test_support::random_value<std::int32_t>(random);
    return values;
  };
  for (int round = 0; round < 20; ++round) {
    const auto pixel = words();
    const auto sample = words();
    const auto depth = words();
    const std::uint64_t seed = random();
    for (const Purpose purpose : {Purpose::camera, Purpose::scatter, Purpose::light}) {
      const Draws draws = draw(seed, pixel, sample, depth, purpose);
      for (std::size_t pe = 0; pe < pixel.size(); ++pe) {
        const Words expected =
            philox({static_cast<std::uint32_t>(pixel[pe]), static_cast<std::uint32_t>(sample[pe]),
                    static_cast<std::uint32_t>(depth[pe]), static_cast<std::uint32_t>(purpose)},
                   seed);
        for (std::size_t i = 0; i < 4; ++i) ASSERT_EQ(word_of(draws[i][pe]), expected[i]);
      }
    }
  }
}

/// Philox is invertible: seed 1 turns these counters into all zeros and all ones.
TEST_F(Random, TheRangeIsOpen) {
  const auto draw_counter = [&](const Words& counter) {
    const auto word = [&](std::size_t i) { return per_pe(static_cast<std::int32_t>(counter[i])); };
    return draw(1, word(0), word(1), word(2), static_cast<Purpose>(counter[3]));
  };
  const Words to_zeros{0xfd264eadu, 0x1fbd5b10u, 0xca90ff34u, 0xd45467c7u};
  const Words to_ones{0x1dda3b71u, 0xde7c12feu, 0x3d0faeb5u, 0x26ee8a86u};
  ASSERT_EQ(philox(to_zeros, 1), (Words{0, 0, 0, 0}));
  ASSERT_EQ(philox(to_ones, 1), (Words{0xffffffffu, 0xffffffffu, 0xffffffffu, 0xffffffffu}));
  const Draws smallest = draw_counter(to_zeros);
  const Draws largest = draw_counter(to_ones);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(smallest[i][0], 0x1p-33);
    EXPECT_EQ(largest[i][0], 1.0 - 0x1p-33);
  }
}

TEST_F(Random, IsEquidistributed) {
  for (const std::uint64_t seed : {1u, 2u}) {
    std::array<ChiSquare, 4> bins{ChiSquare::uniform(256), ChiSquare::uniform(256), ChiSquare::uniform(256),
                                  ChiSquare::uniform(256)};
    ChiSquare pairs = ChiSquare::uniform(32 * 32);
    for_each_draw(seed, 3, Purpose::scatter, [&](const Draws& draws, int) {
      for (std::size_t pe = 0; pe < draws[0].size(); ++pe) {
        for (std::size_t i = 0; i < 4; ++i) bins[i].add(static_cast<std::size_t>(draws[i][pe] * 256));
        pairs.add(static_cast<std::size_t>(draws[0][pe] * 32) * 32 +
                  static_cast<std::size_t>(draws[1][pe] * 32));
      }
    });
    for (const ChiSquare& value : bins) EXPECT_LT(std::abs(value.deviation()), 4.0);
    EXPECT_LT(std::abs(pairs.deviation()), 4.0);
  }
}

/// Returns the sum of products of deviations from the mean; for independent numbers it is a standard normal
/// deviate.
double correlation(const PerPe<double>& a, const PerPe<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - 0.5) * (b[i] - 0.5) * 12.0;
  return sum / std::sqrt(static_cast<double>(a.size()));
}

TEST_F(Random, PurposesDepthsSamplesPixelsAndSeedsAreIndependent) {
  struct Key {
    std::uint64_t seed;
    int depth;
    Purpose purpose;
    int shift;  // of the pixel numbers
  };
  const Key keys[] = {{1, 0, Purpose::camera, 0},          {1, 0, Purpose::scatter, 0},
                      {1, 0, Purpose::light, 0},           {1, 1, Purpose::scatter, 0},
                      {2, 0, Purpose::scatter, 0},         {1, 0, Purpose::scatter, 1},
                      {1ull << 32, 0, Purpose::scatter, 0}};
  std::vector<PerPe<double>> streams;
  for (const Key& key : keys) {
    std::array<PerPe<double>, 4> values;
    for (int sample = 0; sample < 65; ++sample) {
      PerPe<std::int32_t> pixel = per_pe<std::int32_t>();
      for (int pe = 0; pe < num_pes(); ++pe) pixel[std::size_t(pe)] = pe + key.shift;
      const Draws draws = draw(key.seed, pixel, per_pe(sample), per_pe(key.depth), key.purpose);
      for (std::size_t i = 0; i < 4; ++i) values[i].insert(values[i].end(), draws[i].begin(), draws[i].end());
    }
    for (auto& value : values) {
      streams.push_back({value.begin(), value.end() - num_pes()});
      streams.push_back({value.begin() + num_pes(), value.end()});  // the next sample's
    }
  }
  for (std::size_t i = 0; i < streams.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      EXPECT_LT(std::abs(correlation(streams[i], streams[j])), 4.5) << i << " " << j;
}

TEST_F(Random, CostsTenRoundsOfTwoProductsAndFourConversions) {
  const cn::IssueCounts issued = issued_by([] { uniform4(7, 1, 2, 3, Purpose::light); });
  EXPECT_EQ(issued, test_support::counts({{InstructionClass::int32_mul, 20},
                                          {InstructionClass::int32_alu, 40},
                                          {InstructionClass::convert, 4},
                                          {InstructionClass::fp64_add, 4},
                                          {InstructionClass::fp64_mul, 4}}));
}

}  // namespace random_test
