#pragma once

#include <vector>

#include "firmware/path_tracer/records/records.hpp"
#include "testbench/run/render.hpp"

namespace test_support {

/// A configuration like the command line's, with 96 PEs and the widest level of this machine.
testbench::RenderOptions render_options(path_tracer::Program program, int samples);

/// The results of each path as the firmware leaves them in mono memory, without a film.
std::vector<path_tracer::RadianceRecord> native_paths(const testbench::Scene& scene,
                                                      const testbench::RenderOptions& options);

}  // namespace test_support
