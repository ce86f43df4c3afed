#pragma once

#include "firmware/path_tracer/kernels/kernels.hpp"
#include "firmware/path_tracer/kernels/places.hpp"

/// The light of a vertex, out of several candidates: resampled importance sampling (Talbot, Cline, Egbert,
/// "Importance Resampling for Global Illumination", Eurographics Symposium on Rendering 2005). The candidates
/// are chosen as a single light is, one is taken in proportion to its estimated effect at the vertex, and the
/// quotient of the mean estimate and its own makes up for that. The sum is unbiased whatever the estimates
/// are, as long as none is 0.
namespace path_tracer {

/// Chooses the candidates. Their random numbers are one number and its shifts by 1 / count, so that they are
/// spread over all lights; each alone is uniform, which is all that the mean depends on.
inline void find_light_candidates(const LightCandidatesArguments& arguments) {
  const PolyPointer<PathRecord>& path = arguments.path;
  const CandidateNumbers numbers =
      candidate_numbers(arguments.sampler, arguments.seed, path.get(&PathRecord::pixel),
                        path.get(&PathRecord::sample), path.get(&PathRecord::depth));
  path.set(&PathRecord::light_v, numbers.position);
  arguments.resampling.set(&LightResampling::choice, numbers.choice);
  for (int i = 0; i < arguments.count; ++i) {
    const poly<double> shifted = numbers.light + double(i) / arguments.count;
    const poly<double> u = cn::select(shifted >= 1.0, shifted - 1.0, shifted);
    const CdfEntry light = choose_light_by(arguments.light_table, u);
    const PolyPointer<CandidateLookUp> look_up = arguments.look_ups[i];
    look_up.set(&CandidateLookUp::place, place_of(arguments.candidates, light.entry, sizeof(LightCandidate)));
    look_up.set(&CandidateLookUp::rest, light.rest);
  }
}

/// Least share of a cosine, so that no estimate is 0.
inline constexpr double kLeastEstimate = 0x1p-14;

/// Keeps the distance to a light at the vertex from being 0.
inline constexpr double kLeastSquare = 1e-280;

/// What the light would do at the vertex if nothing were between, over the probability of choosing it, up to
/// a factor that all lights have in common. The cosine at the vertex is that of the light's highest point.
inline poly<double> estimate_effect(const PolyPointer<LightCandidate>& light, const Point3& position,
                                    const Direction3& normal) {
  const auto number = [&](float LightCandidate::*field) { return cn::convert<double>(light.get(field)); };
  const auto vector = [&](vec3<float> LightCandidate::*field) {
    const vec3<poly<float>> v = light.get(field);
    return Direction3{cn::convert<double>(v.x), cn::convert<double>(v.y), cn::convert<double>(v.z)};
  };
  const Direction3 to_light = vector(&LightCandidate::centre) - position;
  const Direction3 axis = vector(&LightCandidate::axis);
  const poly<double> radius = number(&LightCandidate::radius);
  const poly<double> distance_squared = cn::max(dot(to_light, to_light), poly<double>(kLeastSquare));
  const poly<double> inverse_distance = 1.0 / cn::sqrt(distance_squared);
  const auto bounded = [](const poly<double>& cosine) {
    return cn::min(cn::max(cosine, poly<double>(kLeastEstimate)), poly<double>(1.0));
  };
  const poly<double> here = bounded((dot(to_light, normal) + radius) * inverse_distance);
  const poly<double> there = bounded(1.0 - dot(axis, axis) - dot(to_light, axis) * inverse_distance);
  return number(&LightCandidate::weight) * here * there / (distance_squared + radius * radius);
}

/// Takes one of the candidates.
inline void resample_light(const LightCandidatesArguments& arguments) {
  const mask front = arguments.hit.get(&HitRecord::front) != 0;
  const Point3 position = arguments.hit.get(&HitRecord::position);
  const Direction3 surface_normal = arguments.surface.get(&SurfaceRecord::normal);
  const Direction3 normal = cn::select(front, surface_normal, surface_normal * -1.0);
  poly<double> estimates[kMaxLightCandidates];
  poly<double> total = 0.0;
  for (int i = 0; i < arguments.count; ++i) {
    estimates[i].assign_all_lanes(
        estimate_effect(arguments.look_ups[i].part(&CandidateLookUp::candidate), position, normal));
    total.assign_all_lanes(total + estimates[i]);
  }
  const auto place_of_candidate = [&](int i) { return arguments.look_ups[i].get(&CandidateLookUp::place); };
  const auto rest_of = [&](int i) { return arguments.look_ups[i].get(&CandidateLookUp::rest); };
  const poly<double> threshold = arguments.resampling.get(&LightResampling::choice) * total;
  poly<double> below = 0.0;
  poly<double> estimate = estimates[0];
  poly<MonoAddress> place = place_of_candidate(0);
  poly<double> rest = rest_of(0);
  for (int i = 1; i < arguments.count; ++i) {
    below.assign_all_lanes(below + estimates[i - 1]);
    cn::poly_if(threshold >= below, [&] {
      estimate = estimates[i];
      place = place_of_candidate(i);
      rest = rest_of(i);
    });
  }
  constexpr int kLogCandidateBytes = 5;
  static_assert(sizeof(LightCandidate) == 1 << kLogCandidateBytes);
  const poly<std::int32_t> light =
      cn::reinterpret_word<std::int32_t>(cn::low_word(place - arguments.candidates) >> kLogCandidateBytes);
  arguments.light_place.write(place_of(arguments.lights, light, sizeof(LightRecord)));
  arguments.path.set(&PathRecord::light_u, rest);
  arguments.resampling.set(&LightResampling::factor, total / (estimate * double(arguments.count)));
}

}  // namespace path_tracer
