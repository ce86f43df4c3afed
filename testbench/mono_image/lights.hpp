#pragma once

#include <cstddef>
#include <vector>

#include "firmware/path_tracer/program/program_config.hpp"
#include "firmware/path_tracer/records/outside.hpp"
#include "firmware/path_tracer/records/records.hpp"
#include "testbench/mono_image/light_pilot.hpp"
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

/// What the host's paths say about a scene's lights: a function of the scene alone, so several renders of it
/// may share one.
struct LightSurvey {
  path_tracer::LightSampling sampling;
  LightWeights weights;
};

/// @param faces of the scene's triangles
/// @throws InputError for a scene without light
LightSurvey survey_lights(const Scene& scene, const std::vector<std::int32_t>& faces,
                          path_tracer::LightSampling sampling);

/// The lights of a scene; none if an environment of one colour alone lights it.
/// @param faces of the scene's triangles
/// @param survey of this scene, or null; one of another sampling is not used
/// @throws InputError for a scene without light
Lights make_lights(const Scene& scene, const std::vector<std::int32_t>& faces,
                   path_tracer::LightSampling sampling, const LightSurvey* survey);

}  // namespace testbench
