#pragma once

#include "testbench/gltf/gltf_document.hpp"
#include "testbench/scene/scene.hpp"

namespace testbench {

/// What a Lambertian picture shows of a glTF material.
struct GltfSurface {
  Material material;
  double alpha = 1.0;
  bool is_masked = false;  ///< parts whose alpha lies below `cutoff` are cut out
  double cutoff = 0.5;
  bool is_double_sided = false;
};

/// Reads a material: baseColorFactor, or diffuseFactor of KHR_materials_pbrSpecularGlossiness, is the
/// reflectance; emissiveFactor times the strength of KHR_materials_emissive_strength the emitted radiance.
/// Notes what else it asks for. Throws InputError for an emission above kMaxEmission.
GltfSurface read_gltf_material(GltfDocument& document, std::size_t index);

}  // namespace testbench
