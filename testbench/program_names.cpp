#include "testbench/program_names.hpp"

namespace testbench {

const char* program_name(path_tracer::Program program) {
  static constexpr const char* kNames[] = {"segments", "direct", "full"};
  return kNames[std::size_t(program)];
}

const char* sampler_name(path_tracer::Sampler sampler) {
  return sampler == path_tracer::Sampler::sobol ? "sobol" : "philox";
}

const char* light_sampling_name(path_tracer::LightSampling sampling) {
  return sampling == path_tracer::LightSampling::solid_angle ? "solid_angle" : "area";
}

const std::vector<std::string>& traversal_names() {
  static const std::vector<std::string> names = {"brute_force", "temporary_bin", "refill",
                                                 "lock_step",   "packets",       "shared_treelets"};
  return names;
}

const std::string& traversal_name(path_tracer::Traversal traversal) {
  return traversal_names().at(std::size_t(traversal));
}

std::map<std::string, path_tracer::Traversal> traversals_by_name() {
  std::map<std::string, path_tracer::Traversal> traversals;
  for (std::size_t i = 0; i < traversal_names().size(); ++i)
    traversals[traversal_names()[i]] = path_tracer::Traversal(i);
  return traversals;
}

const std::vector<std::string>& node_format_names() {
  static const std::vector<std::string> names = {"fp64", "fp32", "quantised8"};
  return names;
}

const std::string& node_format_name(path_tracer::NodeFormat format) {
  return node_format_names().at(std::size_t(format));
}

}  // namespace testbench
