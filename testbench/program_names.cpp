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

const char* traversal_name(path_tracer::Traversal traversal) {
  static constexpr const char* kNames[] = {"brute_force", "temporary_bin", "refill",
                                           "lock_step",   "packets",       "shared_treelets"};
  return kNames[std::size_t(traversal)];
}

const char* node_format_name(path_tracer::NodeFormat format) {
  static constexpr const char* kNames[] = {"fp64", "fp32", "quantised8"};
  return kNames[std::size_t(format)];
}

}  // namespace testbench
