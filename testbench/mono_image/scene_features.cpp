#include "testbench/mono_image/scene_features.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/path_tracer/materials/material.hpp"

namespace testbench {
namespace {

bool is_smooth(double roughness) {
  return roughness * roughness < path_tracer::kSmoothAlpha;
}

/// Adds the lobes that a material has.
void add_lobes(const Material& material, path_tracer::Lobes& lobes) {
  const double dielectric = 1.0 - material.metallic;
  const double opaque = dielectric * (1.0 - material.transmission);
  const bool smooth = is_smooth(material.roughness);
  if (opaque > 0) lobes.diffuse = true;
  if (material.metallic > 0 || opaque * material.specular > 0) (smooth ? lobes.mirror : lobes.glossy) = true;
  if (dielectric * material.transmission > 0) {
    (smooth ? lobes.glass : lobes.rough_glass) = true;
    if (material.is_thin) lobes.thin_glass = true;
    if (!material.is_thin && std::isfinite(material.attenuation_distance)) lobes.absorption = true;
  }
  if (material.clearcoat > 0) lobes.coat = true;
  if (material.sheen_colour != glm::dvec3(0.0)) lobes.sheen = true;
}

}  // namespace

path_tracer::Features features_of(const Scene& scene, const path_tracer::ProgramConfig& config) {
  std::vector<bool> is_used(scene.materials.size());
  for (const Triangle& triangle : scene.triangles) is_used[std::size_t(triangle.material)] = true;
  path_tracer::Features features;
  features.lobes = {};
  for (std::size_t i = 0; i < is_used.size(); ++i)
    if (is_used[i]) add_lobes(scene.materials[i], features.lobes);
  if (!features.lobes.specular() && !features.lobes.coat && !features.lobes.sheen)
    features.lobes.diffuse = true;
  features.lights =
      std::any_of(scene.triangles.begin(), scene.triangles.end(), [&](const Triangle& triangle) {
        return scene.materials[std::size_t(triangle.material)].emission != glm::dvec3(0.0);
      });
  features.normals = !scene.corners.normals.empty();
  features.environment = scene.environment.is_lit() && !scene.environment.image;
  const bool has_shared = features.lobes.evaluable() && !features.lobes.only_diffuse();
  features.multiple_importance = config.program != path_tracer::Program::segments && features.lights &&
                                 (config.estimator == path_tracer::Estimator::mis ||
                                  (config.estimator == path_tracer::Estimator::per_lobe && has_shared));
  return features;
}

path_tracer::ProgramConfig built_for(const Scene& scene, path_tracer::ProgramConfig config) {
  config.features = features_of(scene, config);
  return config;
}

}  // namespace testbench
