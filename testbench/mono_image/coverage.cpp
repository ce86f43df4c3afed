#include "testbench/mono_image/coverage.hpp"

#include "testbench/mono_image/texture_images.hpp"

namespace testbench {

bool lets_rays_through(const Scene& scene, const Material& material) {
  const double least =
      textured_range(scene, material.alpha, shown_texture(material, path_tracer::TextureSlot::alpha)).low;
  switch (material.alpha_mode) {
    case AlphaMode::opaque:
      return false;
    case AlphaMode::mask:
      return least < material.alpha_cutoff;
    case AlphaMode::blend:
      return least < 1.0;
  }
  return false;
}

path_tracer::CoverageRecord coverage_record(const Material& material) {
  path_tracer::CoverageRecord record;
  if (material.alpha_mode == AlphaMode::opaque) return record;
  record.alpha = material.alpha;
  const bool is_mask = material.alpha_mode == AlphaMode::mask;
  record.cutoff = is_mask ? material.alpha_cutoff : path_tracer::CoverageRecord::kByChance;
  record.front_only = material.is_side_of_light ? 1 : 0;
  return record;
}

}  // namespace testbench
