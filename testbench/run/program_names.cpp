#include "testbench/run/program_names.hpp"

namespace testbench {
namespace {

/// The values of an enumeration, whose names are given in its order.
template <class Value>
std::map<std::string, Value> by_name(const std::vector<std::string>& names) {
  std::map<std::string, Value> values;
  for (std::size_t i = 0; i < names.size(); ++i) values[names[i]] = Value(i);
  return values;
}

}  // namespace

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
  return by_name<path_tracer::Traversal>(traversal_names());
}

const std::vector<std::string>& node_format_names() {
  static const std::vector<std::string> names = {"fp64", "fp32", "quantised8"};
  return names;
}

const std::string& node_format_name(path_tracer::NodeFormat format) {
  return node_format_names().at(std::size_t(format));
}

std::map<std::string, path_tracer::NodeFormat> node_formats_by_name() {
  return by_name<path_tracer::NodeFormat>(node_format_names());
}

}  // namespace testbench
