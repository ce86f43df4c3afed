// The whole firmware under the hazard checker: sound, it runs clean however it is configured; with a wait
// left out or with bins that overlap, it is stopped.

#include "firmware/path_tracer/path_tracer.hpp"
#include "tests/support/checked_firmware.hpp"
#include "tests/support/hazards.hpp"
#include "tests/support/scenes.hpp"

namespace hazard_mutation_test {

using path_tracer::Program;
using path_tracer::ProgramConfig;
using path_tracer::Traversal;
using test_support::checked_program;
using test_support::CheckedRun;
using test_support::expect_one_line;
using test_support::expect_parts;
using test_support::kTreeTraversals;
using test_support::Mutation;
using test_support::open_scene;
using test_support::run_checked;
using test_support::small_scene;

constexpr Program kPrograms[] = {Program::segments, Program::direct, Program::full};

void expect_clean(const testbench::Scene& scene, const ProgramConfig& config, int num_pes) {
  const CheckedRun run = run_checked(scene, config, num_pes);
  EXPECT_EQ(run.fault, "") << "program " << int(config.program) << ", traversal " << int(config.traversal)
                           << ", n " << config.n << ", loads " << config.buffer_loads << ", saves "
                           << config.buffer_saves << ", " << config.bin_blocks << " blocks of " << num_pes
                           << " PEs";
  EXPECT_GT(run.requests, 20u);
}

TEST(SoundFirmware, RunsCleanAtEveryLevelOfBuffering) {
  for (const Program program : kPrograms) {
    for (int n = 0; n <= 8; ++n) {
      for (const bool loads : {false, true}) {
        for (const bool saves : {false, true}) {
          ProgramConfig config = checked_program(program, n, std::max(1, n));
          config.buffer_loads = loads;
          config.buffer_saves = saves;
          expect_clean(small_scene(), config, 8);
        }
      }
    }
  }
}

TEST(SoundFirmware, RunsCleanOnEveryShapeOfBins) {
  for (const Program program : kPrograms) {
    for (const int num_pes : {8, 16, 24, 96, 256}) {
      for (const int blocks : {1, 2, 3, 16}) {
        for (const int slot_vertices : {4, 16}) {
          ProgramConfig config = checked_program(program, std::min(3, blocks), blocks);
          config.slot_vertices = slot_vertices;
          expect_clean(small_scene(), config, num_pes);
          expect_clean(open_scene(), config, num_pes);
        }
      }
    }
  }
}

TEST(SoundFirmware, RunsCleanThroughATreeAtEveryLevelOfBuffering) {
  for (const Program program : kPrograms)
    for (const Traversal traversal : kTreeTraversals)
      for (int n = 0; n <= 8; ++n)
        for (const bool loads : {false, true})
          for (const bool saves : {false, true}) {
            ProgramConfig config = checked_program(program, traversal, n, std::max(1, n));
            config.buffer_loads = loads;
            config.buffer_saves = saves;
            expect_clean(small_scene(), config, 8);
            expect_clean(open_scene(), config, 16);
          }
}

TEST(SoundFirmware, RunsCleanThroughEveryShapeOfTreeAndBins) {
  for (const Traversal traversal : kTreeTraversals)
    for (const int num_pes : {8, 24, 96})
      for (const int blocks : {1, 2, 3, 16})
        for (const int nodes : {1, 8})
          for (const int stack : {0, 1, 8}) {
            ProgramConfig config = checked_program(Program::full, traversal, std::min(3, blocks), blocks);
            config.tree.resident_nodes = config.tree.treelet_nodes = nodes;
            config.tree.leaf_triangles = nodes;
            config.tree.stack_entries = stack;
            expect_clean(open_scene(), config, num_pes);
          }
}

TEST(SoundFirmware, RunsCleanAsAStreamProcessorsAtEveryLevelOfBuffering) {
  for (const Program program : kPrograms)
    for (int n = 0; n <= 8; ++n)
      for (const bool loads : {false, true})
        for (const bool saves : {false, true}) {
          ProgramConfig config = checked_program(program, n, std::max(1, n));
          config.execution = path_tracer::Execution::stream;
          config.buffer_loads = loads;
          config.buffer_saves = saves;
          expect_clean(small_scene(), config, 8);
          expect_clean(open_scene(), config, 16);
        }
}

TEST(SoundFirmware, RunsCleanWithTexturesAtEveryLevelOfBuffering) {
  for (const Program program : kPrograms)
    for (const Traversal traversal :
         {Traversal::brute_force, Traversal::temporary_bin, Traversal::refill, Traversal::lock_step})
      for (int n = 0; n <= 8; ++n)
        for (const bool loads : {false, true}) {
          ProgramConfig config = checked_program(program, traversal, n, std::max(1, n));
          config.buffer_loads = loads;
          for (const bool has_textured_light : {false, true})
            expect_clean(test_support::textured_squares({9, 7}, has_textured_light), config, 8);
        }
}

/// Every single wait of a run, one after the other.
void expect_every_wait_is_needed(const testbench::Scene& scene, const ProgramConfig& config) {
  const test_support::CheckedProgram program(scene, config, 8);
  const CheckedRun sound = program.run(1);
  ASSERT_EQ(sound.fault, "");
  ASSERT_GT(sound.waits.size(), 50u);
  for (const int wait : sound.waits) {
    Mutation mutation;
    mutation.dropped_wait = wait;
    const CheckedRun broken = program.run(1, mutation);
    expect_one_line(broken.fault);
    expect_parts(broken.fault, {"hazard", "kernel '", "request ", " bytes, ", "semaphore '"});
    ASSERT_FALSE(testing::Test::HasFailure())
        << "program " << int(config.program) << ", traversal " << int(config.traversal) << ", n " << config.n
        << ", wait " << wait;
  }
}

TEST(BrokenFirmware, IsStoppedWhicheverWaitIsLeftOut) {
  for (const Program program : kPrograms) {
    for (const int n : {0, 1, 3}) {
      expect_every_wait_is_needed(small_scene(), checked_program(program, n));
      expect_every_wait_is_needed(open_scene(), checked_program(program, n));
      if (testing::Test::HasFailure()) return;
    }
  }
}

TEST(BrokenFirmware, IsStoppedWhicheverWaitOfAStreamProcessorIsLeftOut) {
  for (const Program program : kPrograms)
    for (const int n : {0, 1}) {
      ProgramConfig config = checked_program(program, n);
      config.execution = path_tracer::Execution::stream;
      expect_every_wait_is_needed(small_scene(), config);
      if (testing::Test::HasFailure()) return;
    }
}

TEST(BrokenFirmware, IsStoppedWhicheverWaitForTexelsIsLeftOut) {
  for (const int n : {0, 1, 3})
    expect_every_wait_is_needed(test_support::textured_squares({6, 4}), checked_program(Program::full, n));
}

TEST(BrokenFirmware, IsStoppedWhicheverWaitOnTheWayThroughATreeIsLeftOut) {
  for (const Traversal traversal : {Traversal::temporary_bin, Traversal::refill}) {
    expect_every_wait_is_needed(small_scene(), checked_program(Program::direct, traversal, 1));
    for (const int n : {0, 3})
      expect_every_wait_is_needed(small_scene(), checked_program(Program::segments, traversal, n));
    if (testing::Test::HasFailure()) return;
  }
}

TEST(BrokenFirmware, SavesThatOverlapAreNamed) {
  Mutation mutation;
  mutation.layout = [](path_tracer::Layout& layout) {
    layout.ray_bin.address = layout.path_bin.address + 24;
  };
  const CheckedRun broken = run_checked(small_scene(), checked_program(Program::full, 1), 8, 2, mutation);
  expect_one_line(broken.fault);
  expect_parts(broken.fault, {"(save, 448 bytes, semaphore 'save buffer 0') writes 'path bin' (mono bytes ",
                              "which request 0 (save, 320 bytes, ", "still writes"});
}

TEST(BrokenFirmware, BinsThatOverlapAreNamed) {
  Mutation mutation;
  mutation.layout = [](path_tracer::Layout& layout) {
    layout.lighting_bin.address = layout.scatter_bin.address + 64;
  };
  const CheckedRun broken = run_checked(small_scene(), checked_program(Program::full, 1), 8, 2, mutation);
  expect_parts(broken.fault, {"after kernel 'illuminate'", "'scatter bin'", "'save buffer ", "still writes"});
}

TEST(BrokenFirmware, KernelsThatReportNothingAreRefused) {
  const ProgramConfig config = checked_program(Program::full, 1);
  testbench::NativeMachine machine(8, 6144, 1 << 20);
  model::HazardChecker checker(machine);
  machine.set_access_observer(&checker);
  const auto layout = path_tracer::make_layout({12, 12}, 8, config);
  const path_tracer::CameraRecord camera{{}, {}, {}, {}, 4, 4};
  machine.write_mono(layout.camera, camera);
  expect_parts(test_support::fault_of([&] {
                 path_tracer::PathTracer(machine, path_tracer::kernels(cn::narrowest_level()), config, layout,
                                         {0, 1})
                     .run({});
               }),
               {"kernel 'continue_paths' is not built to report"});
}

}  // namespace hazard_mutation_test
