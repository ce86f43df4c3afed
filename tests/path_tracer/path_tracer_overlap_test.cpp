// The firmware on a machine whose transfers finish as late as its waits allow: data that are used before they
// were waited for are garbage there. The results must be those of a machine without any overlap, bit for bit.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <map>

#include "firmware/path_tracer/path_tracer.hpp"
#include "testbench/machine/native_machine.hpp"
#include "testbench/mono_image/mono_image.hpp"
#include "tests/support/late_machine.hpp"

namespace path_tracer_overlap_test {

using path_tracer::HostSemaphores;
using path_tracer::Program;
using path_tracer::ProgramConfig;
using path_tracer::RadianceRecord;

using Radiance = std::array<double, 3>;
using Results = std::map<std::pair<int, int>, Radiance>;  // by pixel and sample

constexpr int kSamples = 3;

/// A box of six white walls with a hole towards the camera's left, and a light below the ceiling.
testbench::Scene make_scene() {
  testbench::Scene scene;
  scene.name = "box";
  scene.film = {8, 6};
  scene.camera.position = {0, 0, -0.9};
  scene.camera.vertical_field_of_view_radians = 1.2;
  scene.materials = {{"wall", {0.9, 0.8, 0.7}, {}}, {"light", {0.5, 0.5, 0.5}, {7, 6, 5}}};
  const auto quad = [&](glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v, int material) {
    scene.triangles.push_back({{corner, corner + u, corner + u + v}, material});
    scene.triangles.push_back({{corner, corner + u + v, corner + v}, material});
  };
  quad({-1, -1, 1}, {2, 0, 0}, {0, 2, 0}, 0);
  quad({-1, -1, -1}, {2, 0, 0}, {0, 2, 0}, 0);
  quad({-1, -1, -1}, {2, 0, 0}, {0, 0, 2}, 0);
  quad({-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, 0);
  quad({-1, -1, -1}, {0, 2, 0}, {0, 0, 2}, 0);
  quad({1, -1, -1}, {0, 2, 0}, {0, 0, 1.5}, 0);
  quad({-0.5, 0.9, -0.5}, {1, 0, 0}, {0, 0, 1}, 1);
  return scene;
}

ProgramConfig small_program(Program program, int n) {
  ProgramConfig config;
  config.program = program;
  config.n = n;
  config.bin_blocks = 8;
  config.slot_vertices = 4;  // many paths are folded
  config.max_survival = 0.9;
  return config;
}

/// The host: reads the halves of the results in turn.
class Host {
 public:
  Host(const std::uint8_t* mono, const path_tracer::Layout& layout) : mono_(mono), layout_(layout) {}

  void fetch() {
    path_tracer::ResultsHeader header;
    std::memcpy(&header, mono_ + layout_.results_header[half_].address, sizeof(header));
    const std::uint8_t* next = mono_ + layout_.results[half_].address;
    half_ = 1 - half_;
    for (int i = 0; i < header.records; ++i, next += sizeof(RadianceRecord)) {
      RadianceRecord record;
      std::memcpy(&record, next, sizeof(record));
      if (record.pixel >= 0) add(record);
    }
  }
  const Results& results() const { return results_; }

 private:
  void add(const RadianceRecord& record) {
    const Radiance radiance{record.radiance.x, record.radiance.y, record.radiance.z};
    const bool is_new = results_.insert({{record.pixel, record.sample}, radiance}).second;
    EXPECT_TRUE(is_new) << "twice: pixel " << record.pixel << " sample " << record.sample;
  }

  const std::uint8_t* mono_;
  const path_tracer::Layout& layout_;
  int half_ = 0;
  Results results_;
};

template <class Machine>
path_tracer::RunCounts trace(Machine& machine, const testbench::MonoImage& image,
                             const ProgramConfig& config) {
  std::memcpy(machine.mono(), image.bytes.data(), image.bytes.size());
  path_tracer::PathTracer tracer(machine, path_tracer::kernels(cn::narrowest_level()), config, image.layout,
                                 {0, kSamples});
  tracer.run({});
  return tracer.counts();
}

Results without_overlap(const ProgramConfig& config, int num_pes, path_tracer::RunCounts* counts = nullptr) {
  const testbench::MonoImage image = testbench::make_mono_image(make_scene(), num_pes, config);
  testbench::NativeMachine machine(num_pes, 6144, image.layout.total_bytes);
  Host host(machine.mono(), image.layout);
  machine.on_signal(HostSemaphores::kResultsReady, [&] {
    host.fetch();
    machine.sem_signal(HostSemaphores::kResultsFree);
  });
  const path_tracer::RunCounts found = trace(machine, image, config);
  if (counts != nullptr) *counts = found;
  return host.results();
}

/// @param prompt_host whether the host reads results when they are announced; otherwise it reads them when
/// the firmware cannot continue without
Results with_overlap(const ProgramConfig& config, int num_pes, double eagerness, bool prompt_host) {
  const testbench::MonoImage image = testbench::make_mono_image(make_scene(), num_pes, config);
  test_support::LateMachine machine(num_pes, 6144, image.layout.total_bytes, eagerness);
  machine.guards_buffers = true;
  Host host(machine.mono(), image.layout);
  const auto serve = [&] {
    if (!machine.take_signal(HostSemaphores::kResultsReady)) return false;
    host.fetch();
    machine.sem_signal(HostSemaphores::kResultsFree);
    return true;
  };
  machine.host = [&](cn::Semaphore) { serve(); };
  if (prompt_host)
    machine.on_signal = [&](cn::Semaphore semaphore) {
      if (semaphore.index == HostSemaphores::kResultsReady.index) serve();
    };
  trace(machine, image, config);
  while (serve()) {
  }
  EXPECT_EQ(machine.under_way(), 0u);
  for (int i = HostSemaphores::kResultsFree.index + 1; i < cn::Machine::kSemaphores; ++i)
    EXPECT_EQ(machine.signals({i}), 0) << "nobody waited for a transfer of " << machine.semaphore_name({i});
  return host.results();
}

void expect_complete(const Results& results) {
  EXPECT_EQ(results.size(), std::size_t(8 * 6 * kSamples));
  int lit = 0;
  for (const auto& [key, radiance] : results) {
    EXPECT_TRUE(key.first >= 0 && key.first < 48 && key.second >= 0 && key.second < kSamples);
    for (const double component : radiance) EXPECT_TRUE(component >= 0 && component < 1e6) << component;
    lit += radiance[0] > 0;
  }
  EXPECT_GT(lit, 20);
}

class Overlap : public testing::TestWithParam<Program> {};

TEST_P(Overlap, ReferenceIsCompleteAndExercisesFolding) {
  path_tracer::RunCounts counts;
  const Results results = without_overlap(small_program(GetParam(), 0), 16, &counts);
  expect_complete(results);
  EXPECT_EQ(counts.paths, std::uint64_t(8 * 6 * kSamples));
  EXPECT_GT(counts.folds, 20u);
  EXPECT_GT(counts.skipped_blocks, 0u);
}

TEST_P(Overlap, NoBufferingChangesTheResults) {
  const Results expected = without_overlap(small_program(GetParam(), 0), 16);
  for (const int n : {0, 1, 2, 3, 8}) {
    for (const auto& [loads, saves] : {std::pair(true, true), {true, false}, {false, true}, {false, false}}) {
      for (const double eagerness : {0.0, 0.2}) {
        SCOPED_TRACE(testing::Message()
                     << "n " << n << " loads " << loads << " saves " << saves << " eagerness " << eagerness);
        ProgramConfig config = small_program(GetParam(), n);
        config.buffer_loads = loads;
        config.buffer_saves = saves;
        EXPECT_EQ(with_overlap(config, 16, eagerness, true), expected);
      }
    }
  }
}

TEST_P(Overlap, NeitherDoesTheShapeOfTheBins) {
  for (const int slot_vertices : {4, 8, 64}) {
    ProgramConfig reference = small_program(GetParam(), 0);
    reference.slot_vertices = slot_vertices;
    const Results expected = without_overlap(reference, 16);
    for (const int num_pes : {8, 24, 96}) {
      for (const int blocks : {1, 2, 3, 16}) {
        SCOPED_TRACE(testing::Message()
                     << num_pes << " PEs, " << blocks << " blocks, " << slot_vertices << " vertices a slot");
        ProgramConfig config = small_program(GetParam(), std::min(2, blocks));
        config.bin_blocks = blocks;
        config.slot_vertices = slot_vertices;
        const Results found = with_overlap(config, num_pes, 0.0, true);
        ASSERT_EQ(found.size(), expected.size());
        EXPECT_EQ(found, expected);
      }
    }
  }
}

/// The length of a slot decides only how a path's recursion is rounded.
TEST_P(Overlap, LengthOfTheSlotsChangesTheRoundingOnly) {
  const Results expected = without_overlap(small_program(GetParam(), 0), 16);
  for (const int slot_vertices : {8, 12, 64}) {
    ProgramConfig config = small_program(GetParam(), 0);
    config.slot_vertices = slot_vertices;
    const Results found = without_overlap(config, 16);
    ASSERT_EQ(found.size(), expected.size());
    for (const auto& [path, radiance] : expected)
      for (std::size_t i = 0; i < 3; ++i) {
        const double there = found.at(path)[i];
        EXPECT_NEAR(there, radiance[i], 1e-13 * radiance[i]) << "pixel " << path.first;
      }
  }
}

TEST_P(Overlap, NorAHostThatReadsAtTheLastMoment) {
  const Results expected = without_overlap(small_program(GetParam(), 0), 16);
  for (const int n : {0, 2})
    EXPECT_EQ(with_overlap(small_program(GetParam(), n), 16, 0.0, false), expected) << n;
}

/// Copies of one kind, and how many of them were waited for by the very next call.
struct Copies {
  int all = 0;
  int waited_for_at_once = 0;
};

Copies copies(const std::vector<std::string>& calls, const std::string& kind) {
  Copies found;
  for (std::size_t i = 0; i + 1 < calls.size(); ++i) {
    if (calls[i].rfind(kind + " ", 0) != 0) continue;
    ++found.all;
    found.waited_for_at_once += calls[i + 1] == "wait " + calls[i].substr(kind.size() + 1);
  }
  return found;
}

/// "0-buffering simply means that each load or save operation was carried out when it occurred in the code"
/// (paper, section 4.1).
TEST_P(Overlap, CopiesOfADirectionWithoutBuffersAreOverAtOnce) {
  for (const auto& [loads, saves] : {std::pair(true, true), {true, false}, {false, true}, {false, false}}) {
    SCOPED_TRACE(testing::Message() << "loads " << loads << " saves " << saves);
    ProgramConfig config = small_program(GetParam(), 1);
    config.buffer_loads = loads;
    config.buffer_saves = saves;
    const testbench::MonoImage image = testbench::make_mono_image(make_scene(), 16, config);
    test_support::LateMachine machine(16, 6144, image.layout.total_bytes);
    machine.on_signal = [&](cn::Semaphore semaphore) {
      if (semaphore.index == HostSemaphores::kResultsReady.index)
        machine.sem_signal(HostSemaphores::kResultsFree);
    };
    trace(machine, image, config);
    const Copies loaded = copies(machine.calls, "m2p");
    const Copies saved = copies(machine.calls, "p2m");
    ASSERT_GT(loaded.all, 100);
    ASSERT_GT(saved.all, 100);
    EXPECT_EQ(loaded.waited_for_at_once == loaded.all, !loads);
    EXPECT_EQ(saved.waited_for_at_once == saved.all, !saves);
  }
}

INSTANTIATE_TEST_SUITE_P(Programs, Overlap,
                         testing::Values(Program::segments, Program::direct, Program::full),
                         [](const auto& test) {
                           return test.param == Program::segments ? "segments"
                                  : test.param == Program::direct ? "direct"
                                                                  : "full";
                         });

TEST(OverlapPrograms, TimingRadianceDoesNotChangeIt) {
  EXPECT_EQ(without_overlap(small_program(Program::direct, 0), 16),
            without_overlap(small_program(Program::full, 0), 16));
}

}  // namespace path_tracer_overlap_test
