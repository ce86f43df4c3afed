#pragma once

#include <cstdint>
#include <vector>

#include "firmware/path_tracer/records/records.hpp"

namespace testbench {

/// Mean number of samples of each pixel, 0 or more.
using MeanSamples = std::vector<double>;

/// Number of samples of each pixel: samples 0, 1, 2, ... of it.
using SampleCounts = std::vector<std::int32_t>;

/// The most samples that a pixel may have.
inline constexpr double kMostPixelSamples = 1 << 30;

/// Rounds each mean down, or up with the probability of its fraction, so that the expected number is the
/// mean. A number that depends on `seed` and the pixel alone decides: a larger mean never gives fewer
/// samples.
SampleCounts counts_of(const MeanSamples& means, std::uint64_t seed);

std::uint64_t total(const SampleCounts& counts);
double total(const MeanSamples& means);

/// The samples that `until` has and `done` has not: the next one of each pixel, then the one after it, and so
/// on; pixels in the order 0, stride, 2 * stride, ... modulo their number, with which `stride` has no divisor
/// in common.
std::vector<path_tracer::CameraSampleRecord> list_samples(const SampleCounts& done, const SampleCounts& until,
                                                          int stride);

}  // namespace testbench
