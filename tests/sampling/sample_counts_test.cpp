#include "testbench/sampling/sample_counts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "firmware/plug_in/random.hpp"
#include "tests/support/statistics.hpp"

namespace sample_counts_test {

using path_tracer::CameraSampleRecord;
using testbench::counts_of;
using testbench::list_samples;
using testbench::MeanSamples;
using testbench::SampleCounts;

TEST(SampleCounts, WholeMeansAreTheCounts) {
  EXPECT_EQ(counts_of({0, 1, 7, 1 << 30}, 5), (SampleCounts{0, 1, 7, 1 << 30}));
}

TEST(SampleCounts, AFractionIsTheProbabilityOfOneMore) {
  constexpr std::size_t kPixels = 100000;
  for (const double mean : {0.001, 0.25, 0.9, 3.5}) {
    const SampleCounts counts = counts_of(MeanSamples(kPixels, mean), 3);
    double more = 0;
    for (const std::int32_t count : counts) {
      ASSERT_TRUE(count == std::floor(mean) || count == std::floor(mean) + 1);
      more += count - std::floor(mean);
    }
    EXPECT_GT(test_support::binomial_tail_bound(more, double(kPixels), mean - std::floor(mean)),
              test_support::per_test(8))
        << mean << ": " << more;
  }
}

TEST(SampleCounts, DependOnSeedAndPixelAndNeverFallWithTheMean) {
  EXPECT_EQ(counts_of(MeanSamples(500, 0.5), 1), counts_of(MeanSamples(500, 0.5), 1));
  EXPECT_NE(counts_of(MeanSamples(500, 0.5), 1), counts_of(MeanSamples(500, 0.5), 2));
  const SampleCounts few = counts_of(MeanSamples(500, 0.5), 1);
  const SampleCounts more = counts_of(MeanSamples(500, 0.75), 1);
  for (std::size_t pixel = 0; pixel < few.size(); ++pixel) EXPECT_LE(few[pixel], more[pixel]);
}

TEST(SampleCounts, AreListedRoundByRound) {
  std::vector<std::pair<int, int>> listed;
  for (const CameraSampleRecord& entry : list_samples({0, 2, 0, 1}, {2, 3, 0, 4}, 1))
    listed.emplace_back(entry.pixel, entry.sample);
  EXPECT_EQ(listed, (std::vector<std::pair<int, int>>{{0, 0}, {1, 2}, {3, 1}, {0, 1}, {3, 2}, {3, 3}}));
}

TEST(SampleCounts, AStrideChangesTheOrderOfPixelsOnly) {
  std::map<std::pair<int, int>, int> times;
  std::vector<int> pixels;
  for (const CameraSampleRecord& entry : list_samples(SampleCounts(5, 0), {1, 2, 1, 1, 1}, 3)) {
    ++times[{entry.pixel, entry.sample}];
    pixels.push_back(entry.pixel);
  }
  EXPECT_EQ(pixels, (std::vector<int>{0, 3, 1, 4, 2, 1}));
  EXPECT_EQ(times.size(), 6u) << "each once";
}

TEST(CounterRandom, IsUniform) {
  constexpr int kCells = 16;
  constexpr int kNumbers = 160000;
  std::vector<int> cells(kCells);
  for (std::uint64_t i = 0; i < kNumbers; ++i) {
    const double value = plug_in::random_of(i);
    ASSERT_TRUE(value >= 0 && value < 1);
    ++cells[std::size_t(value * kCells)];
  }
  for (const int count : cells)
    EXPECT_GT(test_support::binomial_tail_bound(count, kNumbers, 1.0 / kCells),
              test_support::per_test(2 * kCells));
}

}  // namespace sample_counts_test
