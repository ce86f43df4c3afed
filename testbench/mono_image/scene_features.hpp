#pragma once

#include "firmware/path_tracer/program/program_config.hpp"
#include "testbench/scene/scene.hpp"

namespace testbench {

/// What the firmware must be built for to render the scene with these options.
path_tracer::Features features_of(const Scene& scene, const path_tracer::ProgramConfig& config);
/// @param materials of the scene as the firmware is told them (constant_textures.hpp)
path_tracer::Features features_of(const Scene& scene, const std::vector<Material>& materials,
                                  const path_tracer::ProgramConfig& config);

/// Adds the lobes that a material has at any of its texels.
void add_lobes(const Scene& scene, const Material& material, path_tracer::Lobes& lobes);

/// The options with the features of the scene.
path_tracer::ProgramConfig built_for(const Scene& scene, path_tracer::ProgramConfig config);

/// How many candidates pay (ProgramConfig::light_candidates), by the number of lights within the scene; two
/// triangles count as one.
int suited_light_candidates(const Scene& scene);
/// The same for a program, which may have no choice: bidirectional paths take one.
int suited_light_candidates(const Scene& scene, const path_tracer::ProgramConfig& program);

/// Which estimator pays. Shadow rays find the sky by its radiance, hits by the cosine as well: where a vertex
/// takes its light by one candidate, both together have up to half the error on diffuse surfaces, too.
/// @param light_candidates of the program
path_tracer::Estimator suited_estimator(const Scene& scene, int light_candidates);

}  // namespace testbench
