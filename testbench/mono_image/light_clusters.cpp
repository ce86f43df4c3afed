#include "testbench/mono_image/light_clusters.hpp"

#include <algorithm>

#include "testbench/bvh/bvh.hpp"

namespace testbench {
namespace {

using path_tracer::LightShape;

enum class Family { near, distant, environment };

Family family_of(const Emitter& emitter) {
  switch (emitter.shape()) {
    case LightShape::triangle:
    case LightShape::rectangle:
    case LightShape::point:
      return Family::near;
    case LightShape::distant:
      return Family::distant;
    case LightShape::environment:
      break;
  }
  return Family::environment;
}

bool is_one_surface(const std::vector<Emitter>& emitters, const std::vector<std::size_t>& of) {
  const Emitter& first = emitters[of[0]];
  return !first.triangles.empty() && std::all_of(of.begin(), of.end(), [&](std::size_t i) {
    return emitters[i].record.face == first.record.face && emitters[i].material == first.material;
  });
}

LightCluster cluster_of(const std::vector<Emitter>& emitters, std::vector<std::size_t> of) {
  LightCluster cluster;
  double power = 0;
  for (const std::size_t i : of) {
    power += emitters[i].power;
    cluster.power_cdf.push_back(power);
  }
  cluster.emitters = std::move(of);
  return cluster;
}

/// Halves the emitters along the longest axis of their centres.
void split(const std::vector<Emitter>& emitters, std::vector<std::size_t> of, std::size_t most,
           std::vector<LightCluster>& clusters) {
  if (most <= 1 || of.size() == 1 || is_one_surface(emitters, of)) {
    clusters.push_back(cluster_of(emitters, std::move(of)));
    return;
  }
  Box box;
  for (const std::size_t i : of) box.include(emitters[i].centre);
  const glm::dvec3 size = box.upper - box.lower;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::size_t half = of.size() / 2;
  std::nth_element(of.begin(), of.begin() + std::ptrdiff_t(half), of.end(),
                   [&](std::size_t a, std::size_t b) {
                     const double at_a = emitters[a].centre[axis];
                     const double at_b = emitters[b].centre[axis];
                     return at_a != at_b ? at_a < at_b : a < b;
                   });
  const std::vector<std::size_t> upper(of.begin() + std::ptrdiff_t(half), of.end());
  of.resize(half);
  std::sort(of.begin(), of.end());
  split(emitters, std::move(of), most / 2, clusters);
  split(emitters, upper, most - most / 2, clusters);
}

}  // namespace

std::vector<LightCluster> cluster_lights(const std::vector<Emitter>& emitters, std::size_t most) {
  std::vector<LightCluster> clusters;
  for (const Family family : {Family::near, Family::distant, Family::environment}) {
    std::vector<std::size_t> members;
    for (std::size_t i = 0; i < emitters.size(); ++i)
      if (family_of(emitters[i]) == family) members.push_back(i);
    if (!members.empty()) split(emitters, std::move(members), most, clusters);
  }
  return clusters;
}

}  // namespace testbench
