#pragma once

#include <vector>

#include "firmware/path_tracer/records/records.hpp"
#include "testbench/run/render.hpp"

namespace test_support {

/// What the command line would run, on 96 PEs, as wide as this machine can.
testbench::RenderOptions render_options(path_tracer::Program program, int samples);

/// The results as the firmware leaves them in mono memory, one a path, without a film in between.
std::vector<path_tracer::RadianceRecord> native_paths(const testbench::Scene& scene,
                                                      const testbench::RenderOptions& options);

}  // namespace test_support
