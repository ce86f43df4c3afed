#include "testbench/sampling/sample_counts.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "firmware/plug_in/random.hpp"

namespace testbench {

SampleCounts counts_of(const MeanSamples& means, std::uint64_t seed) {
  const std::uint64_t pixels = means.size();
  SampleCounts counts(means.size());
  for (std::uint64_t pixel = 0; pixel < pixels; ++pixel)
    counts[pixel] =
        static_cast<std::int32_t>(std::floor(means[pixel] + plug_in::random_of(seed * pixels + pixel)));
  return counts;
}

std::uint64_t total(const SampleCounts& counts) {
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

double total(const MeanSamples& means) {
  return std::accumulate(means.begin(), means.end(), 0.0);
}

namespace {

/// Pixels with samples to come, in the order in which they are listed.
std::vector<std::int32_t> pixels_left(const SampleCounts& done, const SampleCounts& until, int stride) {
  const std::uint64_t pixels = done.size();
  std::vector<std::int32_t> left;
  for (std::uint64_t i = 0; i < pixels; ++i) {
    const std::uint64_t pixel = i * std::uint64_t(stride) % pixels;
    if (done[pixel] < until[pixel]) left.push_back(static_cast<std::int32_t>(pixel));
  }
  return left;
}

}  // namespace

std::vector<path_tracer::CameraSampleRecord> list_samples(const SampleCounts& done, const SampleCounts& until,
                                                          int stride) {
  std::vector<path_tracer::CameraSampleRecord> list;
  list.reserve(total(until) - total(done));
  std::vector<std::int32_t> left = pixels_left(done, until, stride);
  for (std::int32_t round = 0; !left.empty(); ++round) {
    for (const std::int32_t pixel : left) list.push_back({pixel, done[std::size_t(pixel)] + round});
    left.erase(std::remove_if(left.begin(), left.end(),
                              [&](std::int32_t pixel) {
                                return done[std::size_t(pixel)] + round + 1 >= until[std::size_t(pixel)];
                              }),
               left.end());
  }
  return list;
}

}  // namespace testbench
