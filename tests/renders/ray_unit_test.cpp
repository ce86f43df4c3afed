// Renders whose rays are found by the chip's search unit: the image of brute force, equal to the bit, and
// what the unit counts and costs.

#include <gtest/gtest.h>

#include <functional>

#include "testbench/machine/native_machine.hpp"
#include "testbench/run/render.hpp"
#include "testbench/run/traversal_choice.hpp"
#include "testbench/scene_file/generated_scene.hpp"
#include "testbench/scene_file/scene_file.hpp"
#include "testbench/system/error.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/systemc_fixture.hpp"

namespace ray_unit_test {

using model::TimingStyle;
using path_tracer::NodeFormat;
using path_tracer::Program;
using path_tracer::Traversal;
using testbench::RenderOptions;
using testbench::RenderResult;
using testbench::Scene;

RenderOptions options_for(Program program, Traversal traversal = Traversal::ray_unit) {
  RenderOptions options = test_support::render_options(program, 2);
  options.chip.search_unit.units = 1;
  options.chip.search_unit.buffer_bytes = 1 << 20;
  options.chip.poly.sram_bytes = 32768;  // n = 8 needs more than the CSX600's 6 KiB
  options.program.traversal = traversal;
  options.program.slot_vertices = 4;  // small slots, so that many paths are folded
  return options;
}

Scene generated(testbench::GeneratedScene kind, std::size_t triangles) {
  Scene scene = testbench::generate_scene(kind, triangles);
  scene.film = {16, 12};
  return scene;
}

Scene shipped(const std::string& name) {
  Scene scene = testbench::load_scene(std::string(CSX600_SCENES_DIR) + "/" + name);
  scene.film = {16, 12};
  return scene;
}

struct Variation {
  std::string name;
  std::function<void(RenderOptions&)> apply;
};

std::vector<Variation> variations() {
  std::vector<Variation> variations;
  for (const int n : {0, 1, 3, 8})
    variations.push_back({"n " + std::to_string(n), [=](RenderOptions& o) { o.program.n = n; }});
  for (const int blocks : {1, 3})
    variations.push_back(
        {std::to_string(blocks) + " blocks", [=](RenderOptions& o) { o.program.bin_blocks = blocks; }});
  for (const int pes : {8, 256})
    variations.push_back({std::to_string(pes) + " PEs", [=](RenderOptions& o) { o.chip.chip.pes = pes; }});
  for (const int width : {2, 8})
    variations.push_back({std::to_string(width) + " children a node",
                          [=](RenderOptions& o) { o.program.tree.layout.width = width; }});
  variations.push_back({"exact boxes without a stack", [](RenderOptions& o) {
                          o.program.tree = {{NodeFormat::fp64, 4}, 8, 16, 8, 0};
                        }});
  variations.push_back({"8 quantised children", [](RenderOptions& o) {
                          o.program.tree = {{NodeFormat::quantised8, 8}, 2, 1, 1, 2};
                        }});
  variations.push_back(
      {"bins of hits", [](RenderOptions& o) { o.program.shading = path_tracer::Shading::material_bins; }});
  variations.push_back(
      {"no shadow rays culled", [](RenderOptions& o) { o.program.cull_shadow_rays = false; }});
  variations.push_back({"scene on the chip",
                        [](RenderOptions& o) { o.program.scratchpad = path_tracer::Scratchpad::fitting; }});
  return variations;
}

class RayUnitRenders : public test_support::SystemCFixture {
 protected:
  static RenderResult on_chip(const Scene& scene, const RenderOptions& options) {
    new_context();
    return testbench::render_on_chip(scene, options);
  }
  static std::string expected_image(const Scene& scene, Program program) {
    return testbench::render_natively(scene, options_for(program, Traversal::brute_force)).film.sha256();
  }
  static std::string refusal(const Scene& scene, const RenderOptions& options) {
    try {
      on_chip(scene, options);
      return "";
    } catch (const testbench::InputError& error) {
      return error.what();
    }
  }
};

TEST_F(RayUnitRenders, ShowTheImageOfBruteForceInEveryVariation) {
  const Scene scene = generated(testbench::GeneratedScene::blob, 300);
  for (const Program program : {Program::segments, Program::direct, Program::full}) {
    const std::string expected = expected_image(scene, program);
    for (const Variation& variation : variations()) {
      RenderOptions options = options_for(program);
      variation.apply(options);
      EXPECT_EQ(testbench::render_natively(scene, options).film.sha256(), expected)
          << variation.name << ", program " << int(program);
    }
  }
}

/// Cut-outs, glass, textures, many lights, an environment, coincident triangles: whatever rays are for.
TEST_F(RayUnitRenders, ShowEveryScene) {
  for (const char* name :
       {"textured", "glass", "materials", "many_lights", "environment", "niche", "outdoors"}) {
    const Scene scene = shipped(name);
    RenderOptions options = options_for(Program::full);
    RenderOptions plain = options_for(Program::full, Traversal::brute_force);
    for (RenderOptions* const of : {&options, &plain}) of->program.light_candidates = 4;
    EXPECT_EQ(on_chip(scene, options).film.sha256(), testbench::render_natively(scene, plain).film.sha256())
        << name;
  }
}

TEST_F(RayUnitRenders, AreTheSameOnTheChipInBothStylesAndWithoutHazards) {
  const Scene scene = generated(testbench::GeneratedScene::blob, 1000);
  const std::string expected = expected_image(scene, Program::full);
  RenderOptions options = options_for(Program::full);
  const RenderResult loosely = on_chip(scene, options);
  EXPECT_EQ(loosely.film.sha256(), expected);
  options.check_hazards = true;
  const RenderResult checked = on_chip(scene, options);
  EXPECT_EQ(checked.film.sha256(), expected);
  EXPECT_EQ(checked.chip->firmware_cycles, loosely.chip->firmware_cycles);
  options.check_hazards = false;
  options.timing = TimingStyle::approximately_timed;
  const RenderResult approximately = on_chip(scene, options);
  EXPECT_EQ(approximately.film.sha256(), expected);
  EXPECT_NEAR(double(approximately.chip->firmware_cycles), double(loosely.chip->firmware_cycles),
              0.01 * double(loosely.chip->firmware_cycles));
  EXPECT_EQ(approximately.chip->search_unit.nodes, loosely.chip->search_unit.nodes);
  EXPECT_EQ(approximately.chip->search_unit.leaf_tests, loosely.chip->search_unit.leaf_tests);
}

TEST_F(RayUnitRenders, CountEveryRayAndItsSteps) {
  const Scene scene = generated(testbench::GeneratedScene::blob, 1000);
  const RenderResult result = on_chip(scene, options_for(Program::full));
  const model::SearchStatistics& search = result.chip->search_unit;
  EXPECT_EQ(search.queries, result.counts.segments + result.counts.shadow_rays);
  EXPECT_EQ(search.bytes_written, search.queries * sizeof(path_tracer::QueuedRay));
  EXPECT_EQ(search.node_tests, search.nodes * 4);
  EXPECT_GT(search.nodes, search.queries);
  EXPECT_GT(search.leaf_tests, result.counts.segments);
  EXPECT_EQ(search.bytes_fetched, search.cache_misses * 64);
  EXPECT_EQ(result.chip->bus_search_unit.bytes, search.bytes_fetched);
  EXPECT_EQ(result.counts.traversal.leaf_loads, 0u) << "no PE loads any";
  EXPECT_EQ(on_chip(scene, options_for(Program::full, Traversal::refill)).chip->search_unit.queries, 0u);
}

/// The array waits for a unit that is slow, and a faster one is of no use when I/O is what takes time.
TEST_F(RayUnitRenders, TakeAsLongAsTheSlowestPart) {
  const Scene scene = generated(testbench::GeneratedScene::blob, 1000);
  RenderOptions options = options_for(Program::full);
  const std::uint64_t one = on_chip(scene, options).chip->firmware_cycles;
  options.chip.search_unit.units = 4;
  const std::uint64_t four = on_chip(scene, options).chip->firmware_cycles;
  EXPECT_NEAR(double(four), double(one), 0.01 * double(one));
  options.chip.search_unit.units = 1;
  options.chip.search_unit.queries_in_flight = 1;
  options.chip.search_unit.node_cycles = 200;
  const RenderResult slow = on_chip(scene, options);
  EXPECT_EQ(slow.film.sha256(), expected_image(scene, Program::full));
  EXPECT_GT(slow.chip->firmware_cycles, 2 * one);
  EXPECT_GT(slow.chip->firmware_cycles, slow.chip->search_unit.nodes * 200);
  EXPECT_GT(slow.chip->search_unit.answer_wait_cycles, one);
}

TEST_F(RayUnitRenders, RefuseChipsThatHaveNoRoomForThem) {
  const Scene scene = test_support::small_cornell_box({8, 8});
  RenderOptions options = options_for(Program::full);
  options.chip.search_unit.buffer_bytes = 65536;
  EXPECT_EQ(
      refusal(scene, options),
      "bin_blocks: found 8, allowed is at most 6 with traversal ray_unit: rays of 96 PEs a block in the "
      "search unit's buffer of search_unit.buffer_bytes (65536)");
  options.program.bin_blocks = 6;
  EXPECT_EQ(refusal(scene, options), "");
  options.chip.search_unit.units = 0;
  EXPECT_EQ(refusal(scene, options),
            "traversal: found ray_unit, allowed is a way that the chip has: it is without a search unit "
            "(search_unit.units is 0)");
}

TEST(SearchUnitOfAMachine, IsProgrammedOnlyWhereThereIsOne) {
  testbench::NativeMachine machine(8, 1024, 1024);
  EXPECT_EQ(machine.search_unit().bytes, 0u);
  EXPECT_THROW(machine.program_search_unit(nullptr), cn::MachineFault);
}

TEST_F(RayUnitRenders, TakeBinsThatFitUnlessTheyAreGiven) {
  RenderOptions options = options_for(Program::full);
  options.chip.search_unit.buffer_bytes = 65536;
  path_tracer::ProgramConfig program = options.program;
  testbench::choose_tree(testbench::TriangleCount(36), options.chip, {"traversal"}, program);
  EXPECT_EQ(program.bin_blocks, 6);
  program = options.program;
  EXPECT_THROW(testbench::choose_tree(testbench::TriangleCount(36), options.chip, {"traversal", "bin_blocks"},
                                      program),
               testbench::InputError);
}

}  // namespace ray_unit_test
