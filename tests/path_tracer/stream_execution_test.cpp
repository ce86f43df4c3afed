// The path tracer as the firmware of a stream processor: no PE keeps anything from one kernel to the next,
// and the paths are those of the array's firmware, to the bit.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "firmware/path_tracer/path_tracer.hpp"
#include "testbench/machine/native_machine.hpp"
#include "testbench/mono_image/mono_image.hpp"
#include "tests/support/scenes.hpp"

namespace stream_execution_test {

using path_tracer::Execution;
using path_tracer::HostSemaphores;
using path_tracer::Program;
using path_tracer::ProgramConfig;
using path_tracer::RadianceRecord;
using path_tracer::ResultsHeader;
using path_tracer::ScanLevels;

constexpr std::uint64_t kGarbage = 0xdeadbeefdeadbeefu;

/// A machine whose PEs may forget their SRAM whenever a step begins to load. In program `full`, radiance is
/// computed while the next step has been loaded; then its steps forget nothing. The other programs compute it
/// at the end of a pass.
class ForgetfulMachine : public testbench::NativeMachine {
 public:
  ForgetfulMachine(int num_pes, std::uint64_t mono_bytes, bool forgets, Program program)
      : NativeMachine(num_pes, kPolyBytes, mono_bytes),
        forgets_(forgets),
        spared_stage_(program == Program::full ? "fold stage" : "") {}

  int forgotten() const { return forgotten_; }

 protected:
  void start_transfer(const cn::Transfer& transfer) override {
    const std::pair<std::string, int> step(label().stage, label().block);
    if (forgets_ && transfer.direction == cn::Direction::mono_to_poly && step != step_ &&
        step.first != spared_stage_) {
      step_ = step;
      for (int pe = 0; pe < num_pes(); ++pe)
        for (int byte = 0; byte < kPolyBytes; byte += 8) poly_memory().word(pe, byte) = kGarbage;
      ++forgotten_;
    }
    NativeMachine::start_transfer(transfer);
  }

 private:
  static constexpr int kPolyBytes = 32768;
  bool forgets_;
  std::string spared_stage_;
  std::pair<std::string, int> step_;
  int forgotten_ = 0;
};

struct TracedPaths {
  std::vector<RadianceRecord> paths;  ///< by pixel, then by sample
  std::string fault;
  int forgotten = 0;
};

TracedPaths trace(const testbench::Scene& scene, const ProgramConfig& config, int num_pes,
                  bool forgets = false) {
  const testbench::MonoImage image = testbench::make_mono_image(scene, num_pes, config);
  ForgetfulMachine machine(num_pes, image.layout.total_bytes, forgets, config.program);
  std::memcpy(machine.mono(), image.bytes.data(), image.bytes.size());
  TracedPaths traced;
  int half = 0;
  machine.on_signal(HostSemaphores::kResultsReady, [&] {
    const auto* const header =
        reinterpret_cast<const ResultsHeader*>(machine.mono() + image.layout.results_header[half].address);
    const auto* const records =
        reinterpret_cast<const RadianceRecord*>(machine.mono() + image.layout.results[half].address);
    for (int i = 0; i < header->records; ++i)
      if (records[i].pixel >= 0) traced.paths.push_back(records[i]);
    half = 1 - half;
    machine.sem_signal(HostSemaphores::kResultsFree);
  });
  try {
    path_tracer::PathTracer tracer(machine, path_tracer::kernels(cn::widest_level()), config, image.layout,
                                   {0, 3});
    tracer.run({});
  } catch (const std::exception& error) {
    traced.fault = error.what();
  }
  traced.forgotten = machine.forgotten();
  std::sort(traced.paths.begin(), traced.paths.end(), [](const RadianceRecord& a, const RadianceRecord& b) {
    return std::tie(a.pixel, a.sample) < std::tie(b.pixel, b.sample);
  });
  return traced;
}

/// To the bit.
bool same_paths(const TracedPaths& a, const TracedPaths& b) {
  return a.paths.size() == b.paths.size() && !a.paths.empty() &&
         std::memcmp(a.paths.data(), b.paths.data(), a.paths.size() * sizeof(RadianceRecord)) == 0;
}

ProgramConfig with(Execution execution, Program program, int n, int bin_blocks) {
  ProgramConfig config;
  config.execution = execution;
  config.program = program;
  config.n = n;
  config.bin_blocks = bin_blocks;
  config.max_survival = 0.9;
  return config;
}

constexpr Program kPrograms[] = {Program::segments, Program::direct, Program::full};

TEST(StreamExecution, KeepsNothingInPesBetweenKernels) {
  const testbench::Scene scene = test_support::small_cornell_box({7, 5});
  for (const Program program : kPrograms) {
    const TracedPaths expected = trace(scene, with(Execution::mtap, program, 0, 3), 16);
    const TracedPaths found = trace(scene, with(Execution::stream, program, 0, 3), 16, true);
    EXPECT_EQ(found.fault, "");
    EXPECT_GT(found.forgotten, 100);
    EXPECT_TRUE(same_paths(found, expected)) << "program " << int(program);
    const TracedPaths array = trace(scene, with(Execution::mtap, program, 0, 3), 16, true);
    EXPECT_FALSE(array.fault.empty() && same_paths(array, expected)) << "the array's PEs do keep something";
  }
}

TEST(StreamExecution, TracesTheSamePathsAtEveryLevelOfBufferingAndWidth) {
  const testbench::Scene scene = test_support::small_cornell_box({9, 7});
  for (const Program program : kPrograms) {
    const TracedPaths expected = trace(scene, with(Execution::mtap, program, 1, 8), 96);
    EXPECT_EQ(expected.paths.size(), 9u * 7u * 3u);
    for (const int n : {0, 1, 2, 3})
      for (const int pes : {8, 32, 256}) {
        const TracedPaths found = trace(scene, with(Execution::stream, program, n, 4), pes);
        EXPECT_EQ(found.fault, "");
        EXPECT_TRUE(same_paths(found, expected)) << "n " << n << ", " << pes << " PEs";
      }
  }
}

/// Slots of four vertices are flushed often, so that numbers of finished and of ended paths differ.
TEST(StreamExecution, NumbersPathsThatFillTheirSlots) {
  const testbench::Scene scene = test_support::closed_cube(0.9, 1.0, {6, 4});
  ProgramConfig config = with(Execution::mtap, Program::full, 1, 3);
  config.slot_vertices = 4;
  const TracedPaths expected = trace(scene, config, 24);
  config.execution = Execution::stream;
  EXPECT_TRUE(same_paths(trace(scene, config, 24), expected));
}

/// Blocks that never had a path take part, too.
TEST(StreamExecution, ProcessesEmptyBlocks) {
  const testbench::Scene scene = test_support::small_cornell_box({5, 4});
  ProgramConfig config = with(Execution::mtap, Program::direct, 1, 12);
  const TracedPaths expected = trace(scene, config, 16);
  config.execution = Execution::stream;
  config.skips_empty_blocks = false;
  EXPECT_TRUE(same_paths(trace(scene, config, 16), expected));
}

TEST(StreamExecution, RefusesWhatNeedsTheArray) {
  ProgramConfig config = with(Execution::stream, Program::full, 1, 8);
  EXPECT_NO_THROW(path_tracer::validate(config));
  config.traversal = path_tracer::Traversal::refill;
  const auto error_of = [&] {
    try {
      path_tracer::validate(config);
    } catch (const path_tracer::ProgramError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(error_of(), "traversal: found refill, allowed is brute_force with execution stream");
  config.traversal = path_tracer::Traversal::brute_force;
  config.shading = path_tracer::Shading::material_bins;
  EXPECT_EQ(
      error_of(),
      "shading: found material_bins, allowed is every_lobe or present_lobes with execution stream, which "
      "sorts no hits");
}

TEST(ScanLevels, EndInASingleWord) {
  const ScanLevels levels(768);
  EXPECT_EQ(std::vector<int>(levels.words.begin(), levels.words.begin() + levels.count),
            (std::vector<int>{768, 96, 12, 2, 1}));
  EXPECT_EQ(levels.first[1], 768u);
  EXPECT_EQ(levels.first[3], 768u + 96u + 16u) << "a level ends with a whole group";
  EXPECT_EQ(levels.all_words, 768u + 96u + 16u + 8u + 8u);
  EXPECT_EQ(ScanLevels(8).top(), 1);
  EXPECT_LE(ScanLevels(1 << 30).count, ScanLevels::kMaxLevels);
}

}  // namespace stream_execution_test
