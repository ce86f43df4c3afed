// Whole renders through a tree give the image of brute force, equal to the bit, with every traversal.

#include <functional>

#include "testbench/run/render.hpp"
#include "testbench/scene_file/generated_scene.hpp"
#include "testbench/system/error.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/systemc_fixture.hpp"

namespace traversal_render_test {

using path_tracer::NodeFormat;
using path_tracer::Program;
using path_tracer::Traversal;
using testbench::GeneratedScene;
using testbench::RenderOptions;
using testbench::RenderResult;
using testbench::Scene;

constexpr Program kPrograms[] = {Program::segments, Program::direct, Program::full};
constexpr Traversal kTraversals[] = {Traversal::temporary_bin,   Traversal::refill,  Traversal::lock_step,
                                     Traversal::shared_treelets, Traversal::packets, Traversal::large_packets,
                                     Traversal::ray_streams};

Scene scene_of(GeneratedScene kind) {
  Scene scene = testbench::generate_scene(kind, 300);
  scene.film = {16, 12};
  return scene;
}

RenderOptions options_for(Program program, Traversal traversal) {
  RenderOptions options = test_support::render_options(program, 2);
  options.chip.poly.sram_bytes = 32768;  // n = 8 needs more than the CSX600's 6 KiB
  options.program.traversal = traversal;
  options.program.slot_vertices = 4;  // small slots, so that many paths are folded
  return options;
}

struct Variation {
  std::string name;
  std::function<void(RenderOptions&)> apply;
};

std::vector<Variation> variations() {
  std::vector<Variation> variations;
  for (const int n : {0, 1, 2, 3, 8})
    variations.push_back({"n " + std::to_string(n), [=](RenderOptions& o) { o.program.n = n; }});
  variations.push_back({"unbuffered loads", [](RenderOptions& o) { o.program.buffer_loads = false; }});
  variations.push_back({"unbuffered saves", [](RenderOptions& o) { o.program.buffer_saves = false; }});
  for (const int blocks : {1, 2, 3, 16})
    variations.push_back(
        {std::to_string(blocks) + " blocks", [=](RenderOptions& o) { o.program.bin_blocks = blocks; }});
  for (const int pes : {16, 256})
    variations.push_back({std::to_string(pes) + " PEs", [=](RenderOptions& o) {
                            o.chip.chip.pes = pes;
                            o.program.bin_blocks = 2;
                            o.program.n = 2;
                          }});
  variations.push_back({"small pieces", [](RenderOptions& o) {
                          o.program.tree = {{NodeFormat::quantised8, 4}, 1, 1, 1, 0};
                        }});
  variations.push_back({"large pieces", [](RenderOptions& o) {
                          o.program.tree = {{NodeFormat::fp64, 4}, 8, 16, 8, 32};
                        }});
  for (const int width : {2, 8})
    variations.push_back({std::to_string(width) + " children a node",
                          [=](RenderOptions& o) { o.program.tree.layout.width = width; }});
  variations.push_back({"8 quantised children", [](RenderOptions& o) {
                          o.program.tree = {{NodeFormat::quantised8, 8}, 2, 1, 1, 2};
                        }});
  for (const int blocks : {1, 3, 16})
    variations.push_back({std::to_string(blocks) + " blocks a packet", [=](RenderOptions& o) {
                            o.program.packet_blocks = blocks;
                            o.program.bin_blocks = 20;
                          }});
  for (const int visits : {0, 1})
    variations.push_back({std::to_string(visits) + " visits a turn",
                          [=](RenderOptions& o) { o.program.tree.visits = visits; }});
  variations.push_back({"narrowest level", [](RenderOptions& o) { o.level = cn::narrowest_level(); }});
  variations.push_back({"lights by solid angle", [](RenderOptions& o) {
                          o.program.light_sampling = path_tracer::LightSampling::solid_angle;
                          o.program.sampler = path_tracer::Sampler::sobol;
                        }});
  variations.push_back(
      {"no shadow rays culled", [](RenderOptions& o) { o.program.cull_shadow_rays = false; }});
  return variations;
}

class TraversalRender : public test_support::SystemCFixture {
 protected:
  static RenderResult on_chip(const Scene& scene, const RenderOptions& options) {
    new_context();
    return testbench::render_on_chip(scene, options);
  }
};

/// Brute force gets the same variation. Other tests show that its image does not depend on most of them.
void expect_images_of_brute_force(const Scene& scene, Program program) {
  for (const Variation& variation : variations()) {
    RenderOptions plain = options_for(program, Traversal::brute_force);
    variation.apply(plain);
    const RenderResult expected = testbench::render_natively(scene, plain);
    for (const Traversal traversal : kTraversals) {
      RenderOptions options = options_for(program, traversal);
      variation.apply(options);
      const RenderResult result = testbench::render_natively(scene, options);
      EXPECT_EQ(result.film.sha256(), expected.film.sha256())
          << variation.name << ", program " << int(program) << ", traversal " << int(traversal);
      EXPECT_EQ(result.counts.segments, expected.counts.segments);
      EXPECT_EQ(result.counts.shadow_rays, expected.counts.shadow_rays);
      if (options.program.uses_packets()) {
        EXPECT_EQ(result.counts.traversal.leaf_loads, 0u) << "leaves are operands of the control unit";
      } else {
        EXPECT_GT(result.counts.traversal.leaf_loads, result.counts.segments / 2);
      }
    }
  }
}

TEST_F(TraversalRender, ShowsTheImageOfBruteForce) {
  for (const GeneratedScene kind : testbench::kGeneratedScenes)
    for (const Program program : kPrograms) {
      expect_images_of_brute_force(scene_of(kind), program);
      ASSERT_FALSE(HasFailure()) << name_of(kind);
    }
}

/// Scenes in which most paths end at once, and in which none does.
TEST_F(TraversalRender, ShowsOpenAndClosedScenes) {
  expect_images_of_brute_force(test_support::triangle_soup(60, 3, {9, 7}), Program::full);
  expect_images_of_brute_force(test_support::closed_cube(0.8, 1.0, {6, 4}), Program::full);
  expect_images_of_brute_force(test_support::small_cornell_box({12, 12}), Program::direct);
}

/// Camera rays of distant pixels are processed together. The order of rays changes no pixel.
TEST_F(TraversalRender, ShowsTheSameImageInAnyOrderOfPixels) {
  const Scene scene = scene_of(GeneratedScene::blob);  // a film of 192 pixels
  const RenderResult in_order =
      testbench::render_natively(scene, options_for(Program::full, Traversal::brute_force));
  for (const int stride : {5, 77, 191, 193, 1000001})
    for (const Traversal traversal : {Traversal::brute_force, Traversal::refill, Traversal::packets,
                                      Traversal::large_packets, Traversal::ray_streams}) {
      RenderOptions options = options_for(Program::full, traversal);
      options.program.pixel_stride = stride;
      EXPECT_EQ(testbench::render_natively(scene, options).film.sha256(), in_order.film.sha256())
          << stride << ", traversal " << int(traversal);
    }
}

TEST_F(TraversalRender, RefusesAStrideThatLeavesPixelsOut) {
  RenderOptions options = options_for(Program::full, Traversal::brute_force);
  options.program.pixel_stride = 9;
  try {
    testbench::render_natively(scene_of(GeneratedScene::blob), options);
    FAIL() << "no error";
  } catch (const testbench::InputError& error) {
    EXPECT_STREQ(error.what(),
                 "pixel stride: found 9, which has a divisor in common with the 192 pixels of the film; "
                 "allowed is any number without");
  }
}

TEST_F(TraversalRender, CountsEachRayOnceInItsFirstPass) {
  for (const Traversal traversal : kTraversals) {
    const RenderOptions options = options_for(Program::direct, traversal);
    const RenderResult result = testbench::render_natively(scene_of(GeneratedScene::blob), options);
    const path_tracer::TraversalCounts& counts = result.counts.traversal;
    ASSERT_EQ(counts.rays.size(), counts.lanes.size());
    // Packets take one pass. Shared treelets come in no order, so all passes but the first count as one.
    const bool in_passes = !options.program.uses_packets() && traversal != Traversal::shared_treelets;
    ASSERT_GT(counts.rays.size(), in_passes ? 2u : 0u);
    EXPECT_EQ(counts.rays[0], result.counts.segments + result.counts.shadow_rays);
    EXPECT_LE(counts.rays_before_tail, counts.lanes_before_tail);
    std::uint64_t rays = 0;
    std::uint64_t lanes = 0;
    for (std::size_t pass = 0; pass < counts.rays.size(); ++pass) {
      rays += counts.rays[pass];
      lanes += counts.lanes[pass];
      // A block of the temporary bin counts as the pass of its first ray, whatever the pass of its other
      // rays.
      if (in_passes && traversal != Traversal::temporary_bin && pass > 0) {
        EXPECT_LE(counts.rays[pass], counts.rays[pass - 1]);
      }
    }
    EXPECT_LE(rays, lanes);
    EXPECT_LE(counts.leaf_loads, rays);
  }
}

TEST_F(TraversalRender, IsTheSameOnTheChipInBothStylesOfTiming) {
  const Scene scene = scene_of(GeneratedScene::needles);
  const std::string expected =
      testbench::render_natively(scene, options_for(Program::full, Traversal::brute_force)).film.sha256();
  for (const Traversal traversal : kTraversals)
    for (const model::TimingStyle timing :
         {model::TimingStyle::loosely_timed, model::TimingStyle::approximately_timed}) {
      RenderOptions options = options_for(Program::full, traversal);
      options.timing = timing;
      const RenderResult chip = on_chip(scene, options);
      EXPECT_EQ(chip.film.sha256(), expected) << int(traversal);
      EXPECT_EQ(chip.chip->control.total(), chip.chip->firmware_cycles);
    }
}

TEST_F(TraversalRender, HasNoHazardsOnTheChipAtAnyN) {
  const Scene scene = scene_of(GeneratedScene::sphere_flake);
  for (const Traversal traversal : kTraversals)
    for (const int n : {0, 1, 2, 3}) {
      RenderOptions options = options_for(Program::full, traversal);
      options.program.n = n;
      options.check_hazards = true;
      EXPECT_EQ(on_chip(scene, options).film.sha256(),
                testbench::render_natively(scene, options).film.sha256());
    }
}

/// The unchanged CSX600.
TEST_F(TraversalRender, FitsSixKibibytesWithOneBlockAhead) {
  const Scene scene = scene_of(GeneratedScene::stadium);
  for (const Traversal traversal : kTraversals) {
    RenderOptions options = options_for(Program::full, traversal);
    options.chip.poly.sram_bytes = 6144;
    EXPECT_EQ(testbench::render_natively(scene, options).counts.paths, 2u * 16 * 12);
  }
}

}  // namespace traversal_render_test
