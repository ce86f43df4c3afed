#include "testbench/mono_image/light_pilot.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <numeric>

#include "testbench/bvh/scene_rays.hpp"
#include "testbench/mono_image/faces.hpp"
#include "testbench/mono_image/light_choice.hpp"
#include "testbench/mono_image/light_clusters.hpp"
#include "testbench/scene/film_ray.hpp"

namespace testbench {
namespace {

constexpr std::size_t kMostClusters = 64;
constexpr int kMostVertices = 6;      // of a path
constexpr int kShadowRays = 1 << 16;  // about, of all paths; a quarter of a second among a million triangles
constexpr int kLeastPaths = 256;
constexpr int kMostPaths = 2048;

/// Shares of choices by power, and in equal parts, whatever the paths saw. With the latter, none of many
/// lights is so unlikely that 32-bit random numbers miss it.
constexpr double kPowerShare = 1.0 / 16.0;
constexpr double kEqualShare = 1.0 / 64.0;

/// Numbers in [0, 1) that depend only on path and index: splitmix64 (Steele, Lea, Flood, "Fast Splittable
/// Pseudorandom Number Generators", OOPSLA 2014).
class PathNumbers {
 public:
  explicit PathNumbers(int path) : state_(std::uint64_t(path) << 32) {}
  double next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return double((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }

 private:
  std::uint64_t state_;
};

glm::dvec3 cosine_direction(const glm::dvec3& normal, PathNumbers& numbers) {
  const double z = 1.0 - 2.0 * numbers.next();
  const double angle = 2.0 * glm::pi<double>() * numbers.next();
  const double radius = std::sqrt(std::max(1.0 - z * z, 0.0));
  const glm::dvec3 sum = normal + glm::dvec3(radius * std::cos(angle), radius * std::sin(angle), z);
  const double length = glm::length(sum);
  return length > 1e-6 ? sum / length : normal;
}

double mean_of_channels(const glm::dvec3& colour) {
  return (colour.x + colour.y + colour.z) / 3.0;
}

/// For each cluster the root of the mean square of what it does: in that proportion clusters are chosen with
/// the least variance.
struct Effects {
  std::vector<double> seen;
  std::vector<double> unoccluded;  ///< if nothing were between a surface and a light
};

/// Paths from the camera that bounce diffusely; at each vertex a shadow ray to each cluster.
class Pilot {
 public:
  Pilot(const Scene& scene, const std::vector<Emitter>& emitters, const std::vector<LightCluster>& clusters)
      : scene_(scene),
        emitters_(emitters),
        clusters_(clusters),
        rays_(scene.triangles),
        surroundings_(surroundings_of(scene)),
        seen_(clusters.size(), 0.0),
        unoccluded_(clusters.size(), 0.0) {}

  void trace(int path) {
    PathNumbers numbers(path);
    const double x = numbers.next() * scene_.film.width;
    const double y = numbers.next() * scene_.film.height;
    const FilmRay ray = film_ray(scene_, x, y);
    glm::dvec3 origin = ray.origin;
    glm::dvec3 direction = glm::normalize(ray.direction);
    for (int vertices = 0; vertices < kMostVertices; ++vertices) {
      const std::optional<SceneRays::Hit> hit = rays_.nearest(origin, direction);
      if (!hit) return;
      const Triangle& triangle = scene_.triangles[hit->triangle];
      const Material& material = scene_.materials[std::size_t(triangle.material)];
      const glm::dvec3 front = glm::normalize(area_normal(triangle));
      const glm::dvec3 normal = glm::dot(front, direction) < 0.0 ? front : -front;
      const glm::dvec3 position = origin + hit->distance * direction;
      const double clearance = 1e-9 * (surroundings_.radius + glm::length(position));
      const double albedo = mean_of_channels(material.reflectance);
      const double scatters = is_mirror(material) ? 0.0 : 1.0 - material.transmission;
      if (numbers.next() < material.transmission) {  // a straight line stands for refraction
        origin = position - clearance * normal;
        continue;
      }
      origin = position + clearance * normal;
      if (albedo * scatters > 0.0) look_at_lights(origin, normal, albedo * scatters, numbers);
      if (numbers.next() >= albedo) return;
      direction = is_mirror(material) ? glm::reflect(direction, normal) : cosine_direction(normal, numbers);
    }
  }

  Effects effects() const { return {roots_of(seen_), roots_of(unoccluded_)}; }

 private:
  static std::vector<double> roots_of(const std::vector<double>& sums) {
    std::vector<double> roots;
    for (const double sum : sums) roots.push_back(std::sqrt(sum));
    return roots;
  }
  static bool is_mirror(const Material& material) {
    return material.metallic > 0.5 && material.roughness < 0.1;
  }

  void look_at_lights(const glm::dvec3& position, const glm::dvec3& normal, double albedo,
                      PathNumbers& numbers) {
    for (std::size_t i = 0; i < clusters_.size(); ++i) {
      const LightCluster& cluster = clusters_[i];
      const double chosen = numbers.next() * cluster.power();
      const double second = numbers.next();  // in an order of its own: that of arguments is the compiler's
      const double first = numbers.next();
      const glm::dvec2 place(first, second);
      const auto found = std::upper_bound(cluster.power_cdf.begin(), cluster.power_cdf.end() - 1, chosen);
      const Emitter& emitter = emitters_[cluster.emitters[std::size_t(found - cluster.power_cdf.begin())]];
      const Sighting sighting = sight(emitter, position, normal, place, surroundings_);
      if (!(sighting.irradiance > 0.0)) continue;
      const double effect = albedo * sighting.irradiance * (cluster.power() / emitter.power);
      unoccluded_[i] += effect * effect;
      constexpr double kBeforeLight = 1.0 - 1e-6;
      if (!rays_.is_blocked(position, sighting.to_light, kBeforeLight)) seen_[i] += effect * effect;
    }
  }

  const Scene& scene_;
  const std::vector<Emitter>& emitters_;
  const std::vector<LightCluster>& clusters_;
  SceneRays rays_;
  Surroundings surroundings_;
  // Sums of squares:
  std::vector<double> seen_;
  std::vector<double> unoccluded_;
};

Effects effects_of(const Scene& scene, const std::vector<Emitter>& emitters,
                   const std::vector<LightCluster>& clusters) {
  constexpr int kUsualVertices = 3;
  const int paths =
      std::clamp(kShadowRays / (kUsualVertices * static_cast<int>(clusters.size())), kLeastPaths, kMostPaths);
  Pilot pilot(scene, emitters, clusters);
  for (int path = 0; path < paths; ++path) pilot.trace(path);
  return pilot.effects();
}

/// The share of each light in what all do; empty if they do nothing.
std::vector<double> shares_of(const std::vector<LightCluster>& clusters, const std::vector<double>& effects,
                              const std::vector<Emitter>& emitters) {
  const double total = std::accumulate(effects.begin(), effects.end(), 0.0);
  if (!(total > 0.0)) return {};
  std::vector<double> shares(emitters.size());
  for (std::size_t i = 0; i < clusters.size(); ++i)
    for (const std::size_t light : clusters[i].emitters)
      shares[light] = effects[i] / total * (emitters[light].power / clusters[i].power());
  return shares;
}

}  // namespace

LightWeights light_weights(const Scene& scene, const std::vector<Emitter>& emitters) {
  LightWeights weights;
  weights.visibility.assign(emitters.size(), 1.0);
  for (const Emitter& emitter : emitters) weights.choice.push_back(emitter.power);
  const std::vector<LightCluster> clusters = cluster_lights(emitters, kMostClusters);
  std::vector<double> seen;
  std::vector<double> unoccluded;
  if (clusters.size() > 1) {
    const Effects effects = effects_of(scene, emitters, clusters);
    seen = shares_of(clusters, effects.seen, emitters);
    unoccluded = shares_of(clusters, effects.unoccluded, emitters);
  }
  if (seen.empty() && emitters.size() <= kMostSingleLights) return weights;

  const double total_power = std::accumulate(weights.choice.begin(), weights.choice.end(), 0.0);
  const double equal_part = kEqualShare / double(emitters.size());
  for (std::size_t i = 0; i < emitters.size(); ++i) {
    const double by_power = weights.choice[i] / total_power;
    const double known = seen.empty() ? by_power : seen[i];
    weights.choice[i] = (1.0 - kPowerShare - kEqualShare) * known + kPowerShare * by_power + equal_part;
    if (seen.empty()) continue;
    weights.visibility[i] = weights.choice[i] / (unoccluded[i] > 0.0 ? unoccluded[i] : by_power);
  }
  return weights;
}

}  // namespace testbench
