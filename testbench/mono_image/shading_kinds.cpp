#include "testbench/mono_image/shading_kinds.hpp"

#include <algorithm>
#include <map>

#include "firmware/path_tracer/materials/lobe_table.hpp"
#include "testbench/mono_image/scene_features.hpp"

namespace testbench {
namespace {

/// What tells kinds apart: the lobes, and the images with Shading::texture_bins.
std::vector<std::int32_t> signature(const Scene& scene, const Material& material,
                                    path_tracer::Shading shading) {
  path_tracer::Lobes lobes;
  add_lobes(scene, material, lobes);
  std::vector<std::int32_t> signature;
  for (const path_tracer::LobeDescription& lobe : path_tracer::kLobeTable)
    signature.push_back(lobes.*lobe.member ? 1 : 0);
  if (shading == path_tracer::Shading::texture_bins)
    for_each_texture(material.textures,
                     [&](const TextureReference& reference) { signature.push_back(reference.texture); });
  return signature;
}

}  // namespace

std::vector<std::int32_t> shading_kinds(const Scene& scene, const std::vector<Material>& materials,
                                        path_tracer::Shading shading) {
  const std::vector<bool> in_use = materials_in_use(scene.triangles, materials.size());
  std::map<std::vector<std::int32_t>, std::int32_t> kind_of;
  std::vector<std::int32_t> kinds(materials.size(), 0);
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    if (!in_use[i]) continue;
    const auto next = static_cast<std::int32_t>(std::min<std::size_t>(kind_of.size(), kMaxShadingKinds - 1));
    kinds[i] = kind_of.emplace(signature(scene, materials[i], shading), next).first->second;
  }
  return kinds;
}

}  // namespace testbench
