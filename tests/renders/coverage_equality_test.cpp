// Images of surfaces that let rays through are the same however they are made.

#include <gtest/gtest.h>

#include <algorithm>

#include "testbench/mono_image/scene_features.hpp"
#include "testbench/run/render.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/systemc_fixture.hpp"

namespace coverage_equality_test {

using path_tracer::Program;
using path_tracer::Traversal;
using testbench::AlphaMode;
using testbench::Material;
using testbench::RenderOptions;
using testbench::Scene;

class CoveredImages : public test_support::SystemCFixture {};

/// Squares with textures in every slot, normal maps among them, some with masks, some there by chance, a lamp
/// among them.
Scene covered_squares(testbench::FilmSize film) {
  Scene scene = test_support::textured_squares(film, true);
  for (std::size_t i = 1; i < scene.materials.size(); ++i) {
    Material& material = scene.materials[i];
    if (i < 7) material.textures.normal.texture = 2;
    if (i == 2) continue;  // opaque
    material.alpha_mode = i % 3 == 0 ? AlphaMode::mask : AlphaMode::blend;
    material.alpha = i % 2 == 0 ? 1.0 : 0.6;
    if (i == 5) continue;
    material.textures.alpha.texture = 1;
    material.textures.alpha.channel = 3;
  }
  return scene;
}

RenderOptions options_for(Traversal traversal, int n) {
  RenderOptions options = test_support::render_options(Program::full, 4);
  options.chip.poly.sram_bytes = 32768;
  options.program.traversal = traversal;
  options.program.n = n;
  options.program.bin_blocks = std::max(n, 2);
  options.program.slot_vertices = 4;
  return options;
}

constexpr Traversal kTraversals[] = {Traversal::brute_force,   Traversal::temporary_bin,   Traversal::refill,
                                     Traversal::lock_step,     Traversal::shared_treelets, Traversal::packets,
                                     Traversal::large_packets, Traversal::ray_streams};

TEST_F(CoveredImages, AreTheSameForEveryTraversalDepthOfBufferingAndWidth) {
  const Scene scene = covered_squares({12, 8});
  ASSERT_TRUE(testbench::features_of(scene, {}).blended_coverage);
  for (const Program program : {Program::segments, Program::full}) {
    RenderOptions options = options_for(Traversal::brute_force, 1);
    options.program.program = program;
    const std::string expected = testbench::render_natively(scene, options).film.sha256();
    for (const Traversal traversal : kTraversals) {
      for (const int n : {0, 1, 3}) {
        options = options_for(traversal, n);
        options.program.program = program;
        options.chip.chip.pes = n == 1 ? 16 : 96;
        EXPECT_EQ(testbench::render_natively(scene, options).film.sha256(), expected)
            << "program " << int(program) << ", traversal " << int(traversal) << ", n " << n;
      }
    }
  }
}

TEST_F(CoveredImages, AreTheSameOnTheChipWithoutHazards) {
  const Scene scene = covered_squares({8, 6});
  for (const Traversal traversal : kTraversals) {
    for (const int n : {0, 2}) {
      RenderOptions options = options_for(traversal, n);
      const std::string expected = testbench::render_natively(scene, options).film.sha256();
      options.check_hazards = true;
      new_context();
      EXPECT_EQ(testbench::render_on_chip(scene, options).film.sha256(), expected)
          << "traversal " << int(traversal) << ", n " << n;
    }
  }
}

/// Hits may wait in bins of their kind, rays that pass among them.
TEST_F(CoveredImages, AreTheSameHoweverHitsAreBinned) {
  const Scene scene = covered_squares({8, 6});
  const std::string expected =
      testbench::render_natively(scene, options_for(Traversal::brute_force, 1)).film.sha256();
  for (const path_tracer::Shading shading :
       {path_tracer::Shading::every_lobe, path_tracer::Shading::material_bins,
        path_tracer::Shading::texture_bins}) {
    for (const Traversal traversal : {Traversal::brute_force, Traversal::refill}) {
      for (const int n : {0, 2}) {
        RenderOptions options = options_for(traversal, n);
        options.program.shading = shading;
        EXPECT_EQ(testbench::render_natively(scene, options).film.sha256(), expected) << int(shading) << n;
        options.check_hazards = true;
        new_context();
        EXPECT_EQ(testbench::render_on_chip(scene, options).film.sha256(), expected) << int(shading) << n;
      }
    }
  }
}

}  // namespace coverage_equality_test
