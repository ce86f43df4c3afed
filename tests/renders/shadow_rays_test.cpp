// Every segment that reaches a reflecting surface has one shadow ray (paper, section 4.1: "a single shadow
// ray per path segment"). Tests also which shadow rays may be left out.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"

namespace shadow_rays_test {

using path_tracer::Program;
using test_support::closed_cube;
using test_support::FilmSize;
using test_support::render_options;
using testbench::render_natively;
using testbench::RenderOptions;
using testbench::RenderResult;
using testbench::Scene;

constexpr FilmSize kFilm{17, 13};

RenderOptions with_every_shadow_ray(Program program, int samples) {
  RenderOptions options = render_options(program, samples);
  options.program.cull_shadow_rays = false;
  return options;
}

RenderResult with_shadow_rays(const Scene& scene, bool cull) {
  RenderOptions options = render_options(Program::full, 16);
  options.program.cull_shadow_rays = cull;
  return render_natively(scene, options);
}

/// A cube whose face `face` does not reflect.
Scene cube_with_a_black_face(std::size_t face) {
  Scene scene = closed_cube(0.9, 0.1, kFilm);
  scene.materials.push_back({"black", {0, 0, 0}, {0, 0, 0}});
  for (std::size_t i = 2 * face; i < 2 * face + 2; ++i)
    scene.triangles[i].material = static_cast<int>(scene.materials.size()) - 1;
  return scene;
}

/// A cube without its face `face`.
Scene cube_with_a_hole(std::size_t face) {
  Scene scene = closed_cube(0.9, 0.1, kFilm);
  const auto first = scene.triangles.begin() + static_cast<std::ptrdiff_t>(2 * face);
  scene.triangles.erase(first, first + 2);
  return scene;
}

TEST(ShadowRays, EverySegmentCastsOneWhereAllReflects) {
  for (const Program program : {Program::direct, Program::full}) {
    const RenderResult result =
        render_natively(closed_cube(0.9, 0.1, kFilm), with_every_shadow_ray(program, 16));
    EXPECT_GT(result.counts.segments, 5 * result.counts.paths);
    EXPECT_EQ(result.counts.shadow_rays, result.counts.segments);
  }
}

/// Without roulette a path's last segment is the one that reaches the black face or leaves through the hole.
/// It alone has no shadow ray.
TEST(ShadowRays, SegmentsThatReachNothingThatReflectsCastNone) {
  RenderOptions options = with_every_shadow_ray(Program::full, 4);
  options.program.roulette_start = 1 << 20;
  for (std::size_t face = 0; face < 6; ++face) {
    for (const Scene& scene : {cube_with_a_black_face(face), cube_with_a_hole(face)}) {
      const RenderResult result = render_natively(scene, options);
      EXPECT_EQ(result.counts.paths, 17u * 13u * 4u);
      EXPECT_GT(result.counts.segments, 2 * result.counts.paths);
      EXPECT_EQ(result.counts.shadow_rays, result.counts.segments - result.counts.paths) << face;
    }
  }
}

TEST(ShadowRays, SegmentsProgramCastsNone) {
  for (const bool cull : {false, true}) {
    RenderOptions options = render_options(Program::segments, 4);
    options.program.cull_shadow_rays = cull;
    EXPECT_EQ(render_natively(closed_cube(0.9, 0.1, kFilm), options).counts.shadow_rays, 0u);
  }
}

TEST(ShadowRays, ThoseThatCannotSeeTheLightMayBeLeftOut) {
  for (const Scene& scene :
       {test_support::small_cornell_box(kFilm), test_support::triangle_soup(40, 3, kFilm),
        closed_cube(0.9, 0.1, kFilm), test_support::sphere_under_light(6, kFilm)}) {
    const RenderResult all = with_shadow_rays(scene, false);
    const RenderResult facing = with_shadow_rays(scene, true);
    EXPECT_GT(facing.counts.shadow_rays, 0u) << scene.name;
    EXPECT_LT(facing.counts.shadow_rays, all.counts.shadow_rays) << scene.name;
    EXPECT_EQ(facing.counts.segments, all.counts.segments) << scene.name;
    EXPECT_EQ(facing.film.sha256(), all.film.sha256()) << scene.name;
    const std::vector<double> pixels = all.film.rgb();
    EXPECT_GT(*std::max_element(pixels.begin(), pixels.end()), 0.0) << scene.name;
  }
}

/// The order in which slots alternate between segments and shadow rays depends on all of these options; the
/// rays do not.
TEST(ShadowRays, TheirNumberDependsOnTheSceneOnly) {
  const Scene scene = test_support::small_cornell_box(kFilm);
  for (const bool cull : {false, true}) {
    RenderOptions options = render_options(Program::full, 8);
    options.program.cull_shadow_rays = cull;
    const RenderResult expected = render_natively(scene, options);
    for (const Program program : {Program::direct, Program::full}) {
      for (const int n : {0, 1, 3}) {
        for (const int pes : {16, 96, 256}) {
          for (const int blocks : {3, 8}) {
            options.program.program = program;
            options.program.n = n;
            options.program.bin_blocks = blocks;
            options.chip.chip.pes = pes;
            const RenderResult found = render_natively(scene, options);
            EXPECT_EQ(found.counts.segments, expected.counts.segments);
            EXPECT_EQ(found.counts.shadow_rays, expected.counts.shadow_rays);
            EXPECT_EQ(found.film.sha256(), expected.film.sha256())
                << "n " << n << ", " << pes << " PEs, " << blocks << " blocks";
          }
        }
      }
    }
  }
}

}  // namespace shadow_rays_test
