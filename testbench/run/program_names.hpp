#pragma once

#include <map>
#include <string>
#include <vector>

#include "firmware/path_tracer/program/program.hpp"

namespace testbench {

/// As the command line and the output files spell them.
const char* program_name(path_tracer::Program program);
const char* sampler_name(path_tracer::Sampler sampler);
const char* light_sampling_name(path_tracer::LightSampling sampling);
const std::string& traversal_name(path_tracer::Traversal traversal);
const std::vector<std::string>& traversal_names();
std::map<std::string, path_tracer::Traversal> traversals_by_name();
const std::vector<std::string>& node_format_names();
const std::string& node_format_name(path_tracer::NodeFormat format);
std::map<std::string, path_tracer::NodeFormat> node_formats_by_name();

}  // namespace testbench
