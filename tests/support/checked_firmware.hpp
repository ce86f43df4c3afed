#pragma once

#include <functional>
#include <string>
#include <vector>

#include "firmware/path_tracer/path_tracer.hpp"
#include "model/hazards/hazard_checker.hpp"
#include "testbench/machine/native_machine.hpp"
#include "testbench/mono_image/mono_image.hpp"
#include "testbench/scene/scene.hpp"

namespace test_support {

/// A deliberate fault in a run of the firmware.
struct Mutation {
  int dropped_wait =
      -1;  ///< number of the wait for a transfer, from 0, that returns at once and takes no signal
  std::function<void(path_tracer::Layout&)> layout = [](path_tracer::Layout&) {};
};

struct CheckedRun {
  std::string fault;           ///< message of the fault; empty if the firmware ended
  std::vector<int> waits;      ///< BrokenMachine::needed_waits()
  std::uint64_t requests = 0;  ///< number of requests that moved data
};

/// The whole path tracer for a scene, which runs natively under the hazard checker, as often as wanted.
class CheckedProgram {
 public:
  CheckedProgram(const testbench::Scene& scene, const path_tracer::ProgramConfig& config, int num_pes);

  CheckedRun run(int samples, const Mutation& mutation = {}) const;

 private:
  const testbench::Scene& scene_;
  path_tracer::ProgramConfig config_;
  int num_pes_;
  testbench::MonoImage image_;
};

CheckedRun run_checked(const testbench::Scene& scene, const path_tracer::ProgramConfig& config, int num_pes,
                       int samples = 2, const Mutation& mutation = {});

/// Twelve triangles that all emit, in a scene that no ray leaves; 6 x 4 pixels.
testbench::Scene small_scene();
/// A scene in which most paths end at once, so that radiance has several blocks of paths per pass; 9 x 7
/// pixels.
testbench::Scene open_scene();

inline path_tracer::ProgramConfig checked_program(path_tracer::Program program, int n, int bin_blocks = 4) {
  path_tracer::ProgramConfig config;
  config.program = program;
  config.n = n;
  config.bin_blocks = bin_blocks;
  config.slot_vertices = 4;  // small slots, so that many paths are folded
  config.max_survival = 0.9;
  return config;
}

inline constexpr path_tracer::Traversal kTreeTraversals[] = {
    path_tracer::Traversal::temporary_bin, path_tracer::Traversal::refill, path_tracer::Traversal::lock_step};

/// The same with a tree of small pieces, so that rays load often.
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
