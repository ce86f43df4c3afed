#pragma once

#include <array>

#include "firmware/path_tracer/records/features.hpp"

namespace path_tracer {

/// A feature that a program may be built for although its scene does not have it, to see what it costs.
struct ExtraFeature {
  const char* name;
  void (*add)(Features& features);
};

inline void add_texture(Features& features, TextureSlot slot) {
  features.textures.uses[int(slot)] = true;
}

/// Lights without triangles are sampled by shadow rays, of which scenes without light have none.
inline void add_lights_without_area(Features& features, bool points, bool distant) {
  if (!features.lights.any()) return;
  features.lights.points = features.lights.points || points;
  features.lights.distant = features.lights.distant || distant;
}

inline void add_every_feature(Features& features) {
  features.lobes = {true, true, true, true, true, true, true, true, true, true, true};
  features.environment = true;
  features.normals = true;
  features.coverage = true;
  features.blended_coverage = true;
  for (bool& uses : features.textures.uses) uses = true;
  features.textures.roughness_with_metallic = false;
  add_lights_without_area(features, true, true);
}

/// Values of the option `built_for`. An image of an environment is not among them, since it has texels to
/// look up, nor are tangents that a file gives, with which a program for anything would not fit a PE.
inline constexpr std::array<ExtraFeature, 21> kBuiltForTable = {{
    {"scene", [](Features&) {}},
    {"glossy", [](Features& features) { features.lobes.glossy = true; }},
    {"mirror", [](Features& features) { features.lobes.mirror = true; }},
    {"glass", [](Features& features) { features.lobes.glass = true; }},
    {"rough_glass", [](Features& features) { features.lobes.rough_glass = true; }},
    {"thin_glass", [](Features& features) { features.lobes.glass = features.lobes.thin_glass = true; }},
    {"coat", [](Features& features) { features.lobes.coat = true; }},
    {"sheen", [](Features& features) { features.lobes.sheen = true; }},
    {"absorption", [](Features& features) { features.lobes.glass = features.lobes.absorption = true; }},
    {"normals", [](Features& features) { features.normals = true; }},
    {"reflectance_texture", [](Features& features) { add_texture(features, TextureSlot::reflectance); }},
    {"emission_texture", [](Features& features) { add_texture(features, TextureSlot::emission); }},
    {"roughness_texture",
     [](Features& features) {
       features.lobes.glossy = true;
       add_texture(features, TextureSlot::roughness);
     }},
    {"normal_texture", [](Features& features) { add_texture(features, TextureSlot::normal); }},
    {"coverage", [](Features& features) { features.coverage = true; }},
    {"alpha_texture",
     [](Features& features) {
       features.coverage = true;
       add_texture(features, TextureSlot::alpha);
     }},
    {"blended_coverage", [](Features& features) { features.coverage = features.blended_coverage = true; }},
    {"environment", [](Features& features) { features.environment = true; }},
    {"points", [](Features& features) { add_lights_without_area(features, true, false); }},
    {"suns", [](Features& features) { add_lights_without_area(features, false, true); }},
    {"anything", add_every_feature},
}};
inline constexpr int kBuiltForScene = 0;
inline constexpr int kBuiltForAnything = static_cast<int>(kBuiltForTable.size()) - 1;

}  // namespace path_tracer
