#include "testbench/mono_image/scene_features.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/path_tracer/materials/material.hpp"
#include "testbench/mono_image/constant_textures.hpp"
#include "testbench/mono_image/coverage.hpp"
#include "testbench/mono_image/material_records.hpp"
#include "testbench/mono_image/mean_emission.hpp"
#include "testbench/mono_image/shading_kinds.hpp"
#include "testbench/mono_image/tangents.hpp"
#include "testbench/mono_image/texture_images.hpp"

namespace testbench {
namespace {

bool is_smooth(double roughness) {
  return roughness * roughness < path_tracer::kSmoothAlpha;
}

}  // namespace

void add_lobes(const Scene& scene, const Material& material, path_tracer::Lobes& lobes) {
  const MaterialTextures& textures = material.textures;
  const TexturedRange metallic = textured_range(scene, material.metallic, textures.metallic);
  const TexturedRange roughness = textured_range(scene, material.roughness, textures.roughness);
  const TexturedRange transmission = textured_range(scene, material.transmission, textures.transmission);
  const double dielectric = 1.0 - metallic.low;
  const double opaque = dielectric * (1.0 - transmission.low);
  const bool has_smooth = is_smooth(roughness.low);
  const bool has_rough = !is_smooth(roughness.high);
  if (opaque > 0) lobes.diffuse = true;
  if (metallic.high > 0 || opaque * material.specular > 0) {
    lobes.mirror = lobes.mirror || has_smooth;
    lobes.glossy = lobes.glossy || has_rough;
  }
  if (opaque > 0 && has_varnish_tint(material)) lobes.varnish_tint = true;
  if (dielectric > 0 && has_transmission_tint(material)) lobes.transmission_tint = true;
  if (dielectric * transmission.high > 0) {
    lobes.glass = lobes.glass || has_smooth;
    lobes.rough_glass = lobes.rough_glass || has_rough;
    if (material.is_thin) lobes.thin_glass = true;
    if (!material.is_thin && std::isfinite(material.attenuation_distance)) lobes.absorption = true;
  }
  if (material.clearcoat > 0) lobes.coat = true;
  if (material.sheen_colour != glm::dvec3(0.0)) lobes.sheen = true;
}

namespace {

/// Adds the slots that a material has a texture for, as far as the lobes of the scene read them.
void add_textures(const Material& material, const path_tracer::Lobes& lobes,
                  path_tracer::TextureSlots& slots) {
  const auto add = [&](path_tracer::TextureSlot slot, bool is_read) {
    if (is_read && shown_texture(material, slot)) slots.uses[int(slot)] = true;
  };
  add(path_tracer::TextureSlot::reflectance, true);
  add(path_tracer::TextureSlot::emission, true);
  add(path_tracer::TextureSlot::metallic, lobes.specular());
  add(path_tracer::TextureSlot::roughness, lobes.specular());
  add(path_tracer::TextureSlot::transmission, lobes.transmissive());
  add(path_tracer::TextureSlot::normal, true);
}

void add_coverage(const Scene& scene, const Material& material, path_tracer::Features& features) {
  if (!lets_rays_through(scene, material)) return;
  features.coverage = true;
  if (material.alpha_mode == AlphaMode::blend) features.blended_coverage = true;
  if (shown_texture(material, path_tracer::TextureSlot::alpha))
    features.textures.uses[int(path_tracer::TextureSlot::alpha)] = true;
}

path_tracer::LightKinds light_kinds(const Scene& scene) {
  const MeanEmission emission(scene);
  path_tracer::LightKinds kinds;
  kinds.surfaces = std::any_of(scene.triangles.begin(), scene.triangles.end(), [&](const Triangle& triangle) {
    return emission.of_material(triangle.material) != glm::dvec3(0.0);
  });
  for (const Light& light : scene.lights) {
    if (light.intensity == glm::dvec3(0.0)) continue;
    const bool is_near = light.kind == LightKind::point || light.kind == LightKind::spot;
    (is_near ? kinds.points : kinds.distant) = true;
  }
  kinds.environment = scene.environment.shows_image();
  return kinds;
}

}  // namespace

path_tracer::Features features_of(const Scene& scene, const path_tracer::ProgramConfig& config) {
  return features_of(scene, shown_materials(scene, config).materials, config);
}

path_tracer::Features features_of(const Scene& scene, const std::vector<Material>& materials,
                                  const path_tracer::ProgramConfig& config) {
  const std::vector<bool> is_used = materials_in_use(scene.triangles, materials.size());
  path_tracer::Features features;
  features.lobes = {};
  for (std::size_t i = 0; i < is_used.size(); ++i)
    if (is_used[i]) add_lobes(scene, materials[i], features.lobes);
  if (!features.lobes.specular() && !features.lobes.coat && !features.lobes.sheen)
    features.lobes.diffuse = true;
  for (std::size_t i = 0; i < is_used.size(); ++i)
    if (is_used[i]) add_textures(materials[i], features.lobes, features.textures);
  for (std::size_t i = 0; i < is_used.size(); ++i)
    if (is_used[i]) add_coverage(scene, materials[i], features);
  features.textures.roughness_with_metallic =
      features.textures.has(path_tracer::TextureSlot::roughness) &&
      features.textures.has(path_tracer::TextureSlot::metallic) &&
      std::all_of(materials.begin(), materials.end(), shows_roughness_with_metallic);
  features.lights = light_kinds(scene);
  features.normals = !scene.corners.normals.empty();
  features.tangents = has_varying_tangents(scene);
  features.environment = scene.environment.is_lit() && !scene.environment.image;
  path_tracer::kBuiltForTable.at(std::size_t(config.built_for)).add(features);
  const bool has_shared = features.lobes.evaluable() && !features.lobes.only_diffuse();
  features.multiple_importance =
      config.program != path_tracer::Program::segments && features.lights.can_be_hit() &&
      (config.is_bidirectional() || config.estimator == path_tracer::Estimator::mis ||
       (config.estimator == path_tracer::Estimator::per_lobe && has_shared));
  if (config.bins_hits()) {
    const std::vector<std::int32_t> kinds = shading_kinds(scene, materials, config.shading);
    features.shading_kinds = 1 + *std::max_element(kinds.begin(), kinds.end());
  }
  return features;
}

path_tracer::ProgramConfig built_for(const Scene& scene, path_tracer::ProgramConfig config) {
  config.features = features_of(scene, config);
  return config;
}

int suited_light_candidates(const Scene& scene) {
  constexpr std::size_t kFewLights = 3;  // below, candidates cost more than they gain (docs/lights.md)
  const MeanEmission emission(scene);
  const auto emitting = std::size_t(std::count_if(
      scene.triangles.begin(), scene.triangles.end(),
      [&](const Triangle& triangle) { return emission.of_material(triangle.material) != glm::dvec3(0.0); }));
  const auto near =
      std::size_t(std::count_if(scene.lights.begin(), scene.lights.end(), [](const Light& light) {
        return light.kind == LightKind::point || light.kind == LightKind::spot;
      }));
  return (emitting + 1) / 2 + near < kFewLights ? 1 : path_tracer::kMaxLightCandidates;
}

int suited_light_candidates(const Scene& scene, const path_tracer::ProgramConfig& program) {
  return program.is_bidirectional() ? 1 : suited_light_candidates(scene);
}

path_tracer::Estimator suited_estimator(const Scene& scene, int light_candidates) {
  return scene.environment.shows_image() && light_candidates == 1 ? path_tracer::Estimator::mis
                                                                  : path_tracer::Estimator::per_lobe;
}

}  // namespace testbench
