#pragma once

#include <functional>
#include <string>
#include <vector>

#include "firmware/path_tracer/path_tracer.hpp"
#include "model/hazards/hazard_checker.hpp"
#include "testbench/machine/native_machine.hpp"
#include "testbench/scene/scene.hpp"

namespace test_support {

/// How a run of the firmware is broken on purpose.
struct Mutation {
  int dropped_wait = -1;  ///< this wait for a transfer returns at once and takes no signal, the first is 0
  std::function<void(path_tracer::Layout&)> layout = [](path_tracer::Layout&) {};
};

struct CheckedRun {
  std::string fault;           ///< empty when the firmware came to its end
  std::vector<int> waits;      ///< BrokenMachine::needed_waits()
  std::uint64_t requests = 0;  ///< that moved data
};

/// The whole path tracer, natively, under the hazard checker.
CheckedRun run_checked(const testbench::Scene& scene, const path_tracer::ProgramConfig& config, int num_pes,
                       int samples = 2, const Mutation& mutation = {});

/// Twelve triangles that all emit, and rays that miss nothing; 6 x 4 pixels.
testbench::Scene small_scene();
/// Most of its paths end at once, so that radiance has several blocks of them a pass; 9 x 7 pixels.
testbench::Scene open_scene();

inline path_tracer::ProgramConfig checked_program(path_tracer::Program program, int n, int bin_blocks = 4) {
  path_tracer::ProgramConfig config;
  config.program = program;
  config.n = n;
  config.bin_blocks = bin_blocks;
  config.slot_vertices = 4;  // many paths are folded
  config.max_survival = 0.9;
  return config;
}

inline constexpr path_tracer::Traversal kTreeTraversals[] = {
    path_tracer::Traversal::temporary_bin, path_tracer::Traversal::refill, path_tracer::Traversal::lock_step};

/// The same through a tree of small pieces, so that rays load often.
inline path_tracer::ProgramConfig checked_program(path_tracer::Program program,
                                                  path_tracer::Traversal traversal, int n,
                                                  int bin_blocks = 4) {
  path_tracer::ProgramConfig config = checked_program(program, n, bin_blocks);
  config.traversal = traversal;
  config.tree.leaf_triangles = 1;
  config.tree.stack_entries = 2;
  return config;
}

}  // namespace test_support
