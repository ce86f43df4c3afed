#pragma once

#include <functional>
#include <string>
#include <vector>

#include "firmware/path_tracer/program/program_options.hpp"
#include "testbench/film/error_curve.hpp"
#include "testbench/run/render.hpp"
#include "testbench/run/traversal_choice.hpp"

namespace testbench {

/// The firmware's options that a curve is labelled by: those that change the error, and n, which changes
/// simulated time and energy.
std::vector<const path_tracer::ProgramOption*> options_of_curves();

/// The program built for the scene, with the traversal and the light candidates that suit scene and chip, as
/// `csx600 render` has it.
/// @param given what is not chosen
path_tracer::ProgramConfig program_for(const Scene& scene, const model::ChipConfig& chip,
                                       const path_tracer::ProgramConfig& program,
                                       const GivenOptions& given = {});

/// Error of one scene with one set of options, against the number of samples.
struct ErrorCurve {
  std::string scene;
  path_tracer::ProgramConfig program;
  std::vector<CurvePoint> points;
};

/// The largest numbers of samples a pixel, powers of two; the first is the larger one.
struct CurveSamples {
  int native = 1;
  int timed = 1;  ///< with the chip's timing; 0: none
};

/// Renders 1, 2, 4, ... samples a pixel natively and, as far as asked, on the chip too, and compares each
/// with the reference of the scene's film's size. The light's pixels do not count. Throws InputError if no
/// other pixel is left, RunError if an image of the chip differs from the native one, and as render_on_chip()
/// does.
std::vector<CurvePoint> measure_error(const Scene& scene, const ExrFilm& reference,
                                      const RenderOptions& options, const CurveSamples& samples,
                                      const std::function<void(double share)>& progress);

}  // namespace testbench
