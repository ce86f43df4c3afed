#pragma once

#include <cstdint>
#include <vector>

#include "firmware/path_tracer/program/program_config.hpp"
#include "testbench/scene/scene.hpp"

namespace testbench {

/// Kinds beyond this number share the last one: each costs every block of slots a comparison.
inline constexpr int kMaxShadingKinds = 64;

/// The kind of each material, from 0 on: materials of the same lobes are of one kind, with
/// Shading::texture_bins if they also use the same images. Materials that no triangle has are of kind 0.
/// @param materials as the firmware is told them (constant_textures.hpp)
std::vector<std::int32_t> shading_kinds(const Scene& scene, const std::vector<Material>& materials,
                                        path_tracer::Shading shading);

}  // namespace testbench
