#pragma once

#include <cstddef>
#include <vector>

#include "firmware/path_tracer/program/program_config.hpp"
#include "firmware/path_tracer/records/outside.hpp"
#include "firmware/path_tracer/records/records.hpp"
#include "testbench/scene/scene.hpp"

namespace testbench {

/// What shadow rays are aimed at.
struct Lights {
  std::vector<path_tracer::LightRecord> records;
  std::vector<path_tracer::LightCandidate> candidates;  ///< one for each
  std::vector<double> cdf;                              ///< of the lights, or of their classes
  std::vector<path_tracer::LightClass> classes;         ///< if there are more than kMostSingleLights
  std::vector<std::vector<std::size_t>> triangles;      ///< of each light; none of a light without area
  std::vector<path_tracer::EnvironmentTexel> environment_texels;
  std::vector<path_tracer::SunRecord> suns;
};

/// The lights of a scene; none if an environment of one colour alone lights it.
/// @param faces of the scene's triangles
/// @throws InputError for a scene without light
Lights make_lights(const Scene& scene, const std::vector<std::int32_t>& faces,
                   path_tracer::LightSampling sampling);

}  // namespace testbench
