#pragma once

#include <filesystem>

#include "testbench/files/file_reach.hpp"
#include "testbench/scene/scene.hpp"
#include "testbench/scene_file/table_reader.hpp"

namespace testbench {

/// Reads [environment] and every [[light]] of a scene.toml into `scene`:
///
///     [environment] constant = [r, g, b]           radiance from everywhere, or
///                   file = "sky.exr"               or .hdr: radiance by direction, environment_place()
///                   scale = s                      of the file, optional
///                   rotation_degrees = [x, y, z]   of the file, optional; a single number turns about y
///     [[light]]     type = "point"                 position, intensity
///                          "spot"                  position, direction, intensity, outer_cone_degrees and
///                                                  inner_cone_degrees, half angles, default 45 and 0
///                          "directional"           direction, irradiance
///                          "sun"                   direction, irradiance, angular_diameter_degrees, default
///                          0.53
///
/// intensity and irradiance are linear RGB, see Light; direction is the one that the light travels in.
/// Throws InputError for an unknown key or a value out of range; see read_radiance_image() for the file.
void read_toml_lights(const toml::table& root, const std::filesystem::path& file, const FileReach& reach,
                      Scene& scene);

/// Moves a light of a mesh file with the mesh. Its intensity stays.
Light moved(Light light, const glm::dmat4& transform);

}  // namespace testbench
