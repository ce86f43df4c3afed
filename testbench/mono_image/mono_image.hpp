#pragma once

#include <cstdint>
#include <vector>

#include "firmware/path_tracer/program/layout.hpp"
#include "testbench/mono_image/constant_textures.hpp"
#include "testbench/mono_image/lights.hpp"
#include "testbench/scene/scene.hpp"

namespace testbench {

/// The content of mono memory that the host uploads before a run: a scene, from address 0, and a list of
/// camera samples.
struct MonoImage {
  path_tracer::Layout layout;
  std::vector<std::uint8_t> bytes;  ///< layout.scene_bytes bytes
  /// The content of layout.camera_samples; empty in a run without a list.
  std::vector<path_tracer::CameraSampleRecord> camera_samples = {};
  TextureUses textures = {};

  std::size_t camera_sample_bytes() const {
    return camera_samples.size() * sizeof(path_tracer::CameraSampleRecord);
  }
};

/// Lays out a scene for the firmware, lengths in the scene's unit. Throws InputError for a scene without
/// light.
/// @param survey of the same scene and unit, so that the host's paths are not traced again; may be null
MonoImage make_mono_image(const Scene& scene, int num_pes, const path_tracer::ProgramConfig& options,
                          const LightSurvey* survey = nullptr);

/// The same with lengths in the scene's normal unit (testbench/scene/normalise.hpp), so that scenes of any
/// size are rendered alike. Every render uses this one.
MonoImage make_normal_mono_image(const Scene& scene, int num_pes, const path_tracer::ProgramConfig& config,
                                 const LightSurvey* survey = nullptr);

/// The survey of a scene for its normal unit. Throws InputError for a scene without light.
LightSurvey make_normal_light_survey(const Scene& scene, path_tracer::LightSampling sampling);

}  // namespace testbench
