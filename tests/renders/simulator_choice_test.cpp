// What native runs choose for the simulator: the same image, and no option that was given.

#include "testbench/run/simulator_choice.hpp"

#include <gtest/gtest.h>

#include <string>

#include "testbench/mono_image/scene_features.hpp"
#include "testbench/scene_file/scene_file.hpp"
#include "tests/support/native_paths.hpp"

namespace simulator_choice_test {

using path_tracer::Shading;
using testbench::RenderOptions;
using testbench::Scene;

Scene shipped(const std::string& name) {
  Scene scene = testbench::load_scene(std::string(CSX600_SCENES_DIR) + "/" + name);
  scene.film = {20, 18};
  return scene;
}

RenderOptions options_for(const Scene& scene) {
  RenderOptions options = test_support::render_options(path_tracer::Program::full, 3);
  options.program.n = 1;
  options.program.bin_blocks = 8;
  options.program = testbench::built_for(scene, options.program);
  return options;
}

TEST(SimulatorChoice, GivesTheImageOfTheFirmware) {
  for (const char* const name : {"cornell_box", "glossy", "glass", "textured", "outdoors"}) {
    const Scene scene = shipped(name);
    RenderOptions options = options_for(scene);
    const std::string expected = render_natively(scene, options).film.sha256();
    suit_to_simulator({}, options);
    EXPECT_EQ(render_natively(scene, options).film.sha256(), expected) << name;
  }
}

TEST(SimulatorChoice, BinsHitsWhereVerticesCostMuch) {
  const auto shading_of = [](const char* name) {
    RenderOptions options = options_for(shipped(name));
    suit_to_simulator({}, options);
    return options.program.shading;
  };
  EXPECT_EQ(shading_of("glossy"), Shading::material_bins);
  EXPECT_EQ(shading_of("glass"), Shading::material_bins);
  EXPECT_EQ(shading_of("textured"), Shading::material_bins);
  EXPECT_EQ(shading_of("cornell_box"), Shading::present_lobes);
  EXPECT_EQ(shading_of("caustic"), Shading::present_lobes);      // a mirror is cheaper than its bin
  EXPECT_EQ(shading_of("environment"), Shading::present_lobes);  // paths leave early
}

TEST(SimulatorChoice, GivenOptionsStay) {
  const Scene scene = shipped("glossy");
  RenderOptions options = options_for(scene);
  options.program.n = 2;
  options.program.bin_blocks = 6;
  suit_to_simulator({"n", "bin_blocks", "shading"}, options);
  EXPECT_EQ(options.program.n, 2);
  EXPECT_EQ(options.program.bin_blocks, 6);
  EXPECT_EQ(options.program.shading, Shading::present_lobes);
}

TEST(SimulatorChoice, BidirectionalPathsSortNoHits) {
  const Scene scene = shipped("glossy");
  RenderOptions options = options_for(scene);
  options.program.paths = path_tracer::Paths::bidirectional;
  suit_to_simulator({}, options);
  EXPECT_EQ(options.program.shading, Shading::present_lobes);
}

}  // namespace simulator_choice_test
