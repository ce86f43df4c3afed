#pragma once

#include "firmware/path_tracer/program/program_config.hpp"
#include "firmware/path_tracer/sampling/sampling.hpp"
#include "firmware/path_tracer/sampling/sobol.hpp"

/// The random numbers of each part of a path, from the configured sampler. All are in (0, 1).
namespace path_tracer {

/// Returns a position within the pixel.
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

/// The counter's word for a purpose.
inline cn::poly<std::uint32_t> word_of(Purpose purpose) {
  return static_cast<std::uint32_t>(purpose);
}

inline ScatterNumbers scatter_numbers(Sampler sampler, std::uint64_t seed,
                                      const cn::poly<std::int32_t>& pixel,
                                      const cn::poly<std::int32_t>& sample,
                                      const cn::poly<std::int32_t>& depth,
                                      const cn::poly<std::uint32_t>& purpose = word_of(Purpose::scatter)) {
  if (sampler == Sampler::sobol) {
    const SobolPoint point = sobol_point(seed, pixel, sample, depth, purpose);
    return {sobol_pair(point), sobol_single(point)};
  }
  const Uniform4 random = uniform4(seed, pixel, sample, depth, purpose);
  return {{random.value[0], random.value[1]}, random.value[2]};
}

/// Returns the number that chooses among a surface's lobes.
inline cn::poly<double> lobe_number(Sampler sampler, std::uint64_t seed, const cn::poly<std::int32_t>& pixel,
                                    const cn::poly<std::int32_t>& sample, const cn::poly<std::int32_t>& depth,
                                    const cn::poly<std::uint32_t>& purpose = word_of(Purpose::lobe)) {
  if (sampler == Sampler::sobol) return sobol_single(sobol_point(seed, pixel, sample, depth, purpose));
  return uniform4(seed, pixel, sample, depth, purpose).value[0];
}

/// Returns two numbers for the direction in which a light path begins.
inline UniformPair emission_numbers(Sampler sampler, std::uint64_t seed, const cn::poly<std::int32_t>& pixel,
                                    const cn::poly<std::int32_t>& sample) {
  if (sampler == Sampler::sobol) return sobol_pair(sobol_point(seed, pixel, sample, 0, Purpose::emission));
  const Uniform4 random = uniform4(seed, pixel, sample, 0, Purpose::emission);
  return {random.value[0], random.value[1]};
}

/// Returns the number that decides whether a surface is there. Each face has its own, because a shadow ray
/// may pass several at one depth.
inline cn::poly<double> coverage_number(Sampler sampler, std::uint64_t seed,
                                        const cn::poly<std::int32_t>& pixel,
                                        const cn::poly<std::int32_t>& sample,
                                        const cn::poly<std::int32_t>& depth,
                                        const cn::poly<std::int32_t>& face,
                                        const cn::poly<std::uint32_t>& of = word_of(Purpose::coverage)) {
  const cn::poly<std::uint32_t> purpose = purpose_for_each(of, face);
  if (sampler == Sampler::sobol) return sobol_single(sobol_point(seed, pixel, sample, depth, purpose));
  return uniform4(seed, pixel, sample, depth, purpose).value[0];
}

/// A light, and a position on it.
struct LightNumbers {
  cn::poly<std::int32_t> light;
  UniformPair position;
};

/// How lights are chosen: each by its probability, or where there are many by classes.
struct LightTable {
  const double* cdf = nullptr;  ///< entry i: probability of lights, or of classes, 0..i
  const LightClass* classes = nullptr;
  int count = 0;  ///< entries of the cdf
};

/// The light that a number in (0, 1) stands for, with the unused part of the number.
inline CdfEntry choose_light_by(const LightTable& table, const cn::poly<double>& u) {
  return table.classes == nullptr ? sample_cdf_stretched(table.cdf, table.count, u)
                                  : sample_light_class(table.cdf, table.classes, table.count, u);
}

/// Numbers for the candidates of a vertex's light.
struct CandidateNumbers {
  cn::poly<double> light;     ///< chooses lights; its unused part is one coordinate of the position
  cn::poly<double> position;  ///< the other coordinate
  cn::poly<double> choice;    ///< among the candidates
};

inline CandidateNumbers candidate_numbers(Sampler sampler, std::uint64_t seed,
                                          const cn::poly<std::int32_t>& pixel,
                                          const cn::poly<std::int32_t>& sample,
                                          const cn::poly<std::int32_t>& depth) {
  if (sampler == Sampler::sobol) {
    const SobolPoint point = sobol_point(seed, pixel, sample, depth, Purpose::light);
    const UniformPair pair = sobol_pair(point);
    return {pair.u, pair.v, sobol_single(point)};
  }
  const Uniform4 random = uniform4(seed, pixel, sample, depth, Purpose::light);
  return {random.value[2], random.value[1], random.value[3]};
}

inline LightNumbers light_numbers(Sampler sampler, std::uint64_t seed, const cn::poly<std::int32_t>& pixel,
                                  const cn::poly<std::int32_t>& sample, const cn::poly<std::int32_t>& depth,
                                  const LightTable& table,
                                  const cn::poly<std::uint32_t>& purpose = word_of(Purpose::light)) {
  if (sampler == Sampler::sobol) {
    // The first number chooses the light, and its unused part the position: both are stratified together.
    const UniformPair pair = sobol_pair(sobol_point(seed, pixel, sample, depth, purpose));
    const CdfEntry chosen = choose_light_by(table, pair.u);
    return {chosen.entry, {chosen.rest, pair.v}};
  }
  const Uniform4 random = uniform4(seed, pixel, sample, depth, purpose);
  const cn::poly<double>& u = random.value[2];
  return {table.classes == nullptr ? sample_cdf(table.cdf, table.count, u)
                                   : sample_light_class(table.cdf, table.classes, table.count, u).entry,
          {random.value[0], random.value[1]}};
}

}  // namespace path_tracer
