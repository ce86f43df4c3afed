#pragma once

#include <vector>

#include "firmware/path_tracer/records/outside.hpp"
#include "testbench/mono_image/emitter.hpp"

namespace testbench {

/// The environment's image, cut into rectangles of texels that are sampled as one light each, uniformly in
/// solid angle. Where radiance varies, rectangles are small. Black ones are left out.
struct EnvironmentCells {
  struct Texels {
    int first_column = 0;
    int first_row = 0;
    int columns = 0;
    int rows = 0;
  };
  std::vector<Texels> texels;
  std::vector<Emitter> emitters;  ///< of these rectangles
};

/// @param radius Surroundings::radius
/// @throws InputError for radiance that is beyond single precision
EnvironmentCells environment_cells(const Scene& scene, double radius);

/// The image as rays look it up.
/// @param pdf of each cell, by solid angle
std::vector<path_tracer::EnvironmentTexel> environment_texels(const Environment& environment,
                                                              const EnvironmentCells& cells,
                                                              const std::vector<float>& pdf);

}  // namespace testbench
