#pragma once

#include "firmware/path_tracer/program.hpp"

namespace testbench {

/// As the command line and the output files spell them.
const char* program_name(path_tracer::Program program);
const char* sampler_name(path_tracer::Sampler sampler);
const char* light_sampling_name(path_tracer::LightSampling sampling);
const char* traversal_name(path_tracer::Traversal traversal);
const char* node_format_name(path_tracer::NodeFormat format);

}  // namespace testbench
