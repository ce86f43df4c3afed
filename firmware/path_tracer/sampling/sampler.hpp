#pragma once

#include "firmware/path_tracer/program/program.hpp"
#include "firmware/path_tracer/sampling/sampling.hpp"
#include "firmware/path_tracer/sampling/sobol.hpp"

/// The random numbers of each part of a path, from the sampler that the program is configured with. All in
/// (0, 1).
namespace path_tracer {

/// Position within the pixel.
inline UniformPair camera_numbers(Sampler sampler, std::uint64_t seed, const cn::poly<std::int32_t>& pixel,
                                  const cn::poly<std::int32_t>& sample) {
  if (sampler == Sampler::sobol) return sobol_pair(sobol_point(seed, pixel, sample, 0, Purpose::camera));
  const Uniform4 random = uniform4(seed, pixel, sample, 0, Purpose::camera);
  return {random.value[0], random.value[1]};
}

struct ScatterNumbers {
  UniformPair direction;
  cn::poly<double> roulette;
};

inline ScatterNumbers scatter_numbers(Sampler sampler, std::uint64_t seed,
                                      const cn::poly<std::int32_t>& pixel,
                                      const cn::poly<std::int32_t>& sample,
                                      const cn::poly<std::int32_t>& depth) {
  if (sampler == Sampler::sobol) {
    const SobolPoint point = sobol_point(seed, pixel, sample, depth, Purpose::scatter);
    return {sobol_pair(point), sobol_single(point)};
  }
  const Uniform4 random = uniform4(seed, pixel, sample, depth, Purpose::scatter);
  return {{random.value[0], random.value[1]}, random.value[2]};
}

/// Which light, and where on it.
struct LightNumbers {
  cn::poly<std::int32_t> light;
  UniformPair position;
};

/// `cdf` holds the probability of light 0..i for each of the `count` lights.
inline LightNumbers light_numbers(Sampler sampler, std::uint64_t seed, const cn::poly<std::int32_t>& pixel,
                                  const cn::poly<std::int32_t>& sample, const cn::poly<std::int32_t>& depth,
                                  const double* cdf, int count) {
  if (sampler == Sampler::sobol) {
    // The first number chooses, and what is left of it places: both are stratified together.
    const UniformPair pair = sobol_pair(sobol_point(seed, pixel, sample, depth, Purpose::light));
    const CdfEntry chosen = sample_cdf_stretched(cdf, count, pair.u);
    return {chosen.entry, {chosen.rest, pair.v}};
  }
  const Uniform4 random = uniform4(seed, pixel, sample, depth, Purpose::light);
  return {sample_cdf(cdf, count, random.value[2]), {random.value[0], random.value[1]}};
}

}  // namespace path_tracer
