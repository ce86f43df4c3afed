#include "testbench/mono_image/light_candidates.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <limits>

namespace testbench {
namespace {

using path_tracer::LightCandidate;
using path_tracer::LightShape;

/// Lights far away are put at so many radii of the scene; all surfaces see them in the same direction then.
constexpr double kFarAway = 1e6;

path_tracer::vec3<float> to_single(const cn::vec3<double>& v) {
  return {float(v.x), float(v.y), float(v.z)};
}
path_tracer::vec3<float> to_single(const glm::dvec3& v) {
  return {float(v.x), float(v.y), float(v.z)};
}

double radius_of_surface(const Emitter& emitter) {
  const auto vector = [](const cn::vec3<double>& v) { return glm::dvec3(v.x, v.y, v.z); };
  const glm::dvec3 vertex = vector(emitter.record.vertex);
  const glm::dvec3 edge1 = vector(emitter.record.edge1);
  const glm::dvec3 edge2 = vector(emitter.record.edge2);
  return std::max({glm::distance(emitter.centre, vertex), glm::distance(emitter.centre, vertex + edge1),
                   glm::distance(emitter.centre, vertex + edge2)});
}

/// @param angular_radius sine of it
LightCandidate far_candidate(const Emitter& emitter, double angular_radius, double scene_radius) {
  const double distance = kFarAway * scene_radius;
  LightCandidate candidate;
  candidate.centre = to_single(distance * emitter.centre);
  candidate.radius = float(distance * angular_radius);
  return candidate;
}

LightCandidate candidate_of(const Emitter& emitter, double scene_radius) {
  switch (emitter.shape()) {
    case LightShape::triangle:
    case LightShape::rectangle:
      return {to_single(emitter.centre), to_single(emitter.record.normal), float(radius_of_surface(emitter)),
              0.0f};
    case LightShape::point: {
      // A spot's axis stands for its cone.
      const bool is_spot = emitter.record.edge2.x != 0.0;
      LightCandidate candidate;
      candidate.centre = to_single(emitter.centre);
      if (is_spot) candidate.axis = to_single(emitter.record.normal);
      return candidate;
    }
    case LightShape::distant:
      return far_candidate(emitter, std::sqrt(emitter.record.edge2.x), scene_radius);
    case LightShape::environment:
      break;
  }
  return far_candidate(emitter, std::min(std::sqrt(emitter.measure / glm::pi<double>()), 1.0), scene_radius);
}

bool is_far(const Emitter& emitter) {
  return emitter.shape() == LightShape::distant || emitter.shape() == LightShape::environment;
}

/// Radiant intensity over probability. Of a light far away: what gives its irradiance from where it is put.
double weight_of(const Emitter& emitter, double probability, double scene_radius) {
  const double channels = emitter.emission.x + emitter.emission.y + emitter.emission.z;
  const double distance = is_far(emitter) ? kFarAway * scene_radius : 1.0;
  return channels * emitter.measure / probability * distance * distance;
}

}  // namespace

std::vector<LightCandidate> light_candidates(const std::vector<Emitter>& emitters, const LightChoice& choice,
                                             const std::vector<double>& visibility, double radius) {
  std::vector<LightCandidate> candidates;
  std::vector<double> weights;
  for (std::size_t i = 0; i < choice.order.size(); ++i) {
    const Emitter& emitter = emitters[choice.order[i]];
    candidates.push_back(candidate_of(emitter, radius));
    // A strong light that is hidden must not be taken for the others' sake.
    weights.push_back(weight_of(emitter, choice.probability[i], radius) * visibility[choice.order[i]]);
  }
  // Only their proportions count; none may be 0.
  const double largest = *std::max_element(weights.begin(), weights.end());
  for (std::size_t i = 0; i < weights.size(); ++i)
    candidates[i].weight = std::max(float(weights[i] / largest), std::numeric_limits<float>::min());
  return candidates;
}

}  // namespace testbench
