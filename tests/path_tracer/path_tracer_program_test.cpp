#include "firmware/path_tracer/program/program_config.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "firmware/path_tracer/path_tracer.hpp"
#include "testbench/machine/native_machine.hpp"

namespace path_tracer_program_test {

using path_tracer::Layout;
using path_tracer::make_layout;
using path_tracer::PathTracer;
using path_tracer::Program;
using path_tracer::ProgramConfig;

/// Returns the message of the ProgramError that a configuration causes; "" if it is accepted.
std::string error_of(const ProgramConfig& config) {
  try {
    path_tracer::validate(config);
  } catch (const path_tracer::ProgramError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    return error.what();
  }
  return "";
}

template <class T>
ProgramConfig with(T ProgramConfig::*member, T value) {
  ProgramConfig config;
  config.*member = value;
  return config;
}

TEST(ProgramConfigTest, TheDefaultAndTheBordersAreValid) {
  EXPECT_EQ(error_of({}), "");
  for (const int n : {0, 8}) EXPECT_EQ(error_of(with(&ProgramConfig::n, n)), "");
  for (const int vertices : {4, 8, 64})
    EXPECT_EQ(error_of(with(&ProgramConfig::slot_vertices, vertices)), "");
  ProgramConfig shortest;
  shortest.bin_blocks = 1;
  EXPECT_EQ(error_of(shortest), "");
  shortest.n = 0;
  EXPECT_EQ(error_of(shortest), "");
  EXPECT_EQ(error_of(with(&ProgramConfig::max_survival, 1e-9)), "");
  EXPECT_EQ(error_of(with(&ProgramConfig::max_survival, std::nextafter(1.0, 0.0))), "");
}

TEST(ProgramConfigTest, ErrorsNameArgumentValueAndWhatIsAllowed) {
  EXPECT_EQ(error_of(with(&ProgramConfig::n, -1)), "n: found -1, allowed is an integer from 0 to 8");
  EXPECT_EQ(error_of(with(&ProgramConfig::n, 9)), "n: found 9, allowed is an integer from 0 to 8");
  EXPECT_EQ(error_of(with(&ProgramConfig::bin_blocks, 0)),
            "bin_blocks: found 0, allowed is an integer from 1 to 65536");
  ProgramConfig config;
  config.n = 5;
  config.bin_blocks = 4;
  EXPECT_EQ(error_of(config), "n: found 5, allowed is at most the bin length, 4 blocks");
  for (const int vertices : {-4, 0, 2, 6, 17})
    EXPECT_EQ(error_of(with(&ProgramConfig::slot_vertices, vertices)),
              "slot_vertices: found " + std::to_string(vertices) +
                  ", allowed is an integer from 4 to 4096, a multiple of 4");
  EXPECT_EQ(error_of(with(&ProgramConfig::roulette_start, -1)),
            "roulette_start: found -1, allowed is an integer from 0 to 1073741824");
  for (const auto& [survival, text] :
       {std::pair(0.0, "0"), {1.0, "1"}, {-0.5, "-0.5"}, {std::numeric_limits<double>::quiet_NaN(), "nan"}})
    EXPECT_EQ(error_of(with(&ProgramConfig::max_survival, survival)),
              "max_survival: found " + std::string(text) + ", allowed is a number above 0 and below 1");
}

/// Returns the message for a tree of that shape.
std::string error_of(const path_tracer::TreeShape& tree) {
  ProgramConfig config;
  config.tree = tree;
  EXPECT_EQ(error_of(config), "") << "brute force uses no tree";
  config.traversal = path_tracer::Traversal::temporary_bin;
  return error_of(config);
}

template <class T>
path_tracer::TreeShape tree_with(T path_tracer::TreeShape::*member, T value) {
  path_tracer::TreeShape tree;
  tree.*member = value;
  return tree;
}

TEST(ProgramConfigTest, ShapesOfTreesAreCheckedWhereThereIsOne) {
  using path_tracer::TreeShape;
  EXPECT_EQ(error_of(TreeShape{}), "");
  for (const int entries : {0, 1, 2, 16, 32})
    EXPECT_EQ(error_of(tree_with(&TreeShape::stack_entries, entries)), "") << entries;
  EXPECT_EQ(error_of(tree_with(&TreeShape::stack_entries, 3)),
            "stack_entries: found 3, allowed is one of 0, 1, 2, 4, 8, 16, 32");
  EXPECT_EQ(error_of(tree_with(&TreeShape::stack_entries, 64)),
            "stack_entries: found 64, allowed is one of 0, 1, 2, 4, 8, 16, 32");
  EXPECT_EQ(error_of(tree_with(&TreeShape::stack_entries, -1)),
            "stack_entries: found -1, allowed is one of 0, 1, 2, 4, 8, 16, 32");
  for (const int visits : {0, 1, 1024}) EXPECT_EQ(error_of(tree_with(&TreeShape::visits, visits)), "");
  EXPECT_EQ(error_of(tree_with(&TreeShape::visits, -1)),
            "visits: found -1, allowed is an integer from 0 to 1024");
  EXPECT_EQ(error_of(tree_with(&TreeShape::leaf_triangles, 0)),
            "leaf_triangles: found 0, allowed is an integer from 1 to 8");
  EXPECT_EQ(error_of(tree_with(&TreeShape::leaf_triangles, 9)),
            "leaf_triangles: found 9, allowed is an integer from 1 to 8");
  EXPECT_EQ(error_of(tree_with(&TreeShape::treelet_nodes, 0)),
            "treelet_nodes: found 0, allowed is an integer from 1 to 1024");
  EXPECT_EQ(error_of(tree_with(&TreeShape::resident_nodes, 1025)),
            "resident_nodes: found 1025, allowed is an integer from 1 to 1024");
  const auto error_of_layout = [](path_tracer::NodeFormat format, int width) {
    return error_of(tree_with(&TreeShape::layout, {format, width}));
  };
  for (const int width : {2, 4, 8}) EXPECT_EQ(error_of_layout(path_tracer::NodeFormat::fp32, width), "");
  EXPECT_EQ(error_of_layout(path_tracer::NodeFormat::fp64, 3),
            "node_width: found 3, allowed is one of 2, 4, 8");
  EXPECT_EQ(error_of_layout(path_tracer::NodeFormat::fp64, 16),
            "node_width: found 16, allowed is one of 2, 4, 8");
  EXPECT_EQ(error_of_layout(path_tracer::NodeFormat::quantised8, 2),
            "node_width: found 2, allowed is 4 or 8 with node_format quantised8");
}

TEST(ProgramConfigTest, BuffersFollowN) {
  for (const int n : {0, 1, 3, 8}) {
    ProgramConfig config;
    config.n = n;
    EXPECT_EQ(config.load_buffers(), n + 1);
    EXPECT_EQ(config.save_buffers(), n + 1);
    config.buffer_loads = false;
    EXPECT_EQ(config.load_buffers(), 1);
    EXPECT_EQ(config.save_buffers(), n + 1);
    config.buffer_saves = false;
    EXPECT_EQ(config.save_buffers(), 1);
  }
}

struct Region {
  std::uint64_t first;
  std::uint64_t bytes;
};

template <class T>
Region region(cn::MonoPointer<T> start, std::uint64_t records) {
  return {start.address, records * sizeof(T)};
}

std::vector<Region> scene_regions(const Layout& layout) {
  const auto triangles = std::uint64_t(layout.triangle_count);
  const auto lights = std::uint64_t(layout.light_count);
  return {region(layout.camera, 1), region(layout.triangles, triangles), region(layout.surfaces, triangles),
          region(layout.lights, lights), region(layout.light_cdf, lights)};
}

std::vector<Region> bin_regions(const Layout& layout, std::uint64_t slots, const ProgramConfig& config) {
  return {region(layout.ray_bin, slots),
          region(layout.intersection_bin, slots),
          region(layout.scatter_bin, slots),
          region(layout.lighting_bin, slots),
          region(layout.direct_light_bin, slots),
          region(layout.path_bin, slots),
          region(layout.vertices, slots * std::uint64_t(config.slot_vertices)),
          region(layout.folds, slots),
          region(layout.finished, slots),
          region(layout.results_header[0], 1),
          region(layout.results_header[1], 1),
          region(layout.results[0], slots),
          region(layout.results[1], slots)};
}

TEST(LayoutTest, NamesCoverEveryRegion) {
  ProgramConfig config;
  const Layout layout = make_layout({37, 5}, 96, config);
  std::vector<Region> expected = scene_regions(layout);
  for (const Region& r : bin_regions(layout, 96 * std::uint64_t(config.bin_blocks), config))
    expected.push_back(r);
  ASSERT_EQ(layout.regions.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(layout.regions[i].first, expected[i].first) << layout.regions[i].name;
    EXPECT_EQ(layout.regions[i].bytes, expected[i].bytes) << layout.regions[i].name;
  }
  EXPECT_STREQ(layout.regions[5].name, "ray bin");
}

TEST(LayoutTest, RegionsAreAlignedApartAndWithinTheirParts) {
  for (const int triangles : {1, 2, 37}) {
    for (const int num_pes : {8, 96, 1024}) {
      for (const int blocks : {1, 16}) {
        SCOPED_TRACE(testing::Message()
                     << triangles << " triangles, " << num_pes << " PEs, " << blocks << " blocks");
        ProgramConfig config;
        config.bin_blocks = blocks;
        config.slot_vertices = 4 * blocks;
        const Layout layout = make_layout({triangles, (triangles + 1) / 2}, num_pes, config);
        EXPECT_EQ(layout.triangle_count, triangles);
        EXPECT_EQ(layout.light_count, (triangles + 1) / 2);

        const std::vector<Region> scene = scene_regions(layout);
        std::vector<Region> all = bin_regions(layout, std::uint64_t(num_pes * blocks), config);
        for (const Region& r : all) EXPECT_GE(r.first, layout.scene_bytes);
        for (const Region& r : scene) EXPECT_LE(r.first + r.bytes, layout.scene_bytes);
        EXPECT_LE(layout.scene_bytes, layout.total_bytes);
        all.insert(all.end(), scene.begin(), scene.end());
        for (std::size_t i = 0; i < all.size(); ++i) {
          EXPECT_EQ(all[i].first % 64, 0u) << "whole DDR packets";
          EXPECT_LE(all[i].first + all[i].bytes, layout.total_bytes);
          for (std::size_t j = 0; j < i; ++j)
            EXPECT_TRUE(all[i].first + all[i].bytes <= all[j].first ||
                        all[j].first + all[j].bytes <= all[i].first)
                << i << " and " << j;
        }
      }
    }
  }
}

/// Checks the regions by name, in the order of their addresses.
TEST(LayoutTest, TreesAddRegionsOfTheirOwn) {
  ProgramConfig config;
  config.traversal = path_tracer::Traversal::temporary_bin;
  config.tree.leaf_triangles = 4;
  const Layout layout = make_layout({37, 5, 11}, 96, config);
  const auto slots = 96 * std::uint64_t(config.bin_blocks);
  std::map<std::string, std::uint64_t> bytes;
  std::uint64_t end = 0;
  for (const Layout::Region& r : layout.regions) {
    EXPECT_GE(r.first, end) << r.name;
    EXPECT_EQ(r.first % 64, 0u) << r.name;
    end = r.first + r.bytes;
    bytes[r.name] = r.bytes;
  }
  EXPECT_LE(end, layout.total_bytes);
  EXPECT_EQ(layout.triangle_count, 37);
  // Two triangles for each light follow the scene's, with room for a whole leaf behind the last.
  EXPECT_EQ(bytes["triangles"], (37 + 2 * 5 + 4) * sizeof(path_tracer::TriangleRecord));
  EXPECT_EQ(bytes["surfaces"], 37 * sizeof(path_tracer::SurfaceRecord));
  EXPECT_EQ(bytes["nodes"], 11u * std::uint64_t(config.tree.layout.node_bytes()));
  EXPECT_LE(layout.nodes.address + bytes["nodes"], layout.scene_bytes);
  EXPECT_EQ(bytes["ray queue"], slots * sizeof(path_tracer::QueuedRay));
  EXPECT_EQ(bytes["surface place bin"], slots * sizeof(cn::MonoAddress));
  EXPECT_EQ(bytes["traversal bin"], 96 * std::uint64_t(path_tracer::traversal_bin_blocks(config)) *
                                        std::uint64_t(config.tree.record_bytes()));
  config.traversal = path_tracer::Traversal::refill;
  for (const Layout::Region& r : make_layout({37, 5, 11}, 96, config).regions)
    EXPECT_STRNE(r.name, "traversal bin") << "rays stay in their PE";
}

/// A program that is set up on a machine of its own and does not run.
struct PreparedProgram {
  PreparedProgram(const ProgramConfig& config, int sram_bytes, int num_pes = 96)
      : layout(make_layout({2, 1}, num_pes, config)), machine(num_pes, sram_bytes, layout.total_bytes) {
    machine.write_mono(layout.camera, path_tracer::CameraRecord{{}, {}, {}, {}, 4, 4});
    tracer.emplace(machine, kernels, config, layout, path_tracer::Work{0, 1});
  }

  Layout layout;
  testbench::NativeMachine machine;
  path_tracer::Kernels kernels;
  std::optional<PathTracer> tracer;
};

TEST(PolySramBudget, EveryProgramFitsSixKibibytesForEveryN) {
  for (const Program program : {Program::segments, Program::direct, Program::full}) {
    int used_before = 0;
    for (int n = 0; n <= path_tracer::kMaxBuffers; ++n) {
      SCOPED_TRACE(testing::Message() << "program " << int(program) << " n " << n);
      ProgramConfig config;
      config.program = program;
      config.n = n;
      config.bin_blocks = 16;
      const PreparedProgram prepared(config, 6144);
      const cn::PolyMemory& memory = prepared.machine.poly_memory();
      EXPECT_LE(memory.used_bytes(), memory.capacity_bytes());
      EXPECT_GT(memory.used_bytes(), used_before);
      used_before = memory.used_bytes();

      int loads = 0;
      int saves = 0;
      for (const auto& buffer : memory.buffers()) {
        EXPECT_EQ(buffer.span.offset_bytes % 8, 0) << buffer.name;
        loads += buffer.name.rfind("load buffer ", 0) == 0;
        saves += buffer.name.rfind("save buffer ", 0) == 0;
      }
      EXPECT_EQ(loads, n + 1);
      EXPECT_EQ(saves, n + 1);
    }
  }
}

/// Each stage cuts its records off one buffer, so the largest stage decides.
TEST(PolySramBudget, BuffersHoldTheLargestStage) {
  const auto sizes = [](Program program) {
    ProgramConfig config;
    config.program = program;
    const PreparedProgram prepared(config, 6144);
    std::pair<int, int> found;
    for (const auto& buffer : prepared.machine.poly_memory().buffers()) {
      if (buffer.name == "load buffer 0") found.first = buffer.span.size_bytes;
      if (buffer.name == "save buffer 0") found.second = buffer.span.size_bytes;
    }
    return found;
  };
  // Bytes of records: ray 56, hit 32, surface 80, path 40, light 112, scatter 104, lighting 32, direct light
  // 24, vertex 48, finished path 24, two addresses 16.
  EXPECT_EQ(sizes(Program::segments), std::pair(40 + 104 + 24, 48 + 40 + 56 + 24 + 16)) << "path bin";
  for (const Program program : {Program::direct, Program::full})
    EXPECT_EQ(sizes(program), std::pair(32 + 80 + 40 + 112, 104 + 56 + 32)) << "intersection bin";
}

TEST(PolySramBudget, BinsThatAreTooLongNameTheBuffer) {
  ProgramConfig config;
  config.bin_blocks = 1000;
  try {
    const PreparedProgram prepared(config, 6144);
    FAIL() << "no overflow";
  } catch (const cn::PolyMemoryOverflow& overflow) {
    EXPECT_STREQ(overflow.what(),
                 "poly SRAM overflow: buffer 'surface places' needs 8000 bytes a PE, 5104 of 6128 are free");
    EXPECT_NE(overflow.map().find("    1024  stack"), std::string::npos) << overflow.map();
  }
  config.bin_blocks = 150;  // room for the places, not for the buffers as well
  config.n = 8;
  try {
    const PreparedProgram prepared(config, 6144);
    FAIL() << "no overflow";
  } catch (const cn::PolyMemoryOverflow& overflow) {
    EXPECT_NE(std::string(overflow.what()).find("buffer 'save buffer "), std::string::npos)
        << overflow.what();
    EXPECT_NE(overflow.map().find("1200  light places"), std::string::npos) << overflow.map();
  }
}

TEST(PolySramBudget, LengthsNoChipCouldHoldAreRefused) {
  for (const int blocks : {1 << 28, 1 << 29, std::numeric_limits<int>::max()}) {
    ProgramConfig config;
    config.bin_blocks = blocks;
    EXPECT_NE(error_of(config), "") << blocks;
  }
  EXPECT_NE(error_of(with(&ProgramConfig::slot_vertices, 1 << 30)), "");
}

TEST(PathTracerStart, ChecksItsConfiguration) {
  ProgramConfig config;
  config.n = 3;
  config.bin_blocks = 2;
  EXPECT_THROW(PreparedProgram(config, 6144), path_tracer::ProgramError);
}

TEST(PathTracerStart, SemaphoresZeroAndOneAreTheHosts) {
  PreparedProgram prepared({}, 6144);
  EXPECT_EQ(prepared.machine.semaphore_name(path_tracer::HostSemaphores::kResultsReady), "results ready");
  EXPECT_EQ(prepared.machine.semaphore_name(path_tracer::HostSemaphores::kResultsFree), "results free");
  EXPECT_THROW(PathTracer(prepared.machine, prepared.kernels, {}, prepared.layout, {}), cn::MachineFault)
      << "a second program on one machine";
}

}  // namespace path_tracer_program_test
