// Paths that stay in the PEs' SRAM: the paths of the bins to the bit, and their image but for the last
// digits, because radiance is summed from the other end.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "model/config/chip_presets.hpp"
#include "testbench/run/render.hpp"
#include "testbench/system/error.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/systemc_fixture.hpp"

namespace resident_paths_test {

using path_tracer::Program;
using test_support::render_options;
using testbench::RenderOptions;
using testbench::RenderResult;
using testbench::Scene;

constexpr testbench::FilmSize kFilm{23, 17};

RenderOptions options_with(int resident_paths, int samples = 4) {
  RenderOptions options = render_options(Program::full, samples);
  options.program.roulette_start = 3;
  options.program.resident_paths = resident_paths;
  return options;
}

/// The difference of two images over the brightest channel.
double distance_of(const testbench::Film& a, const testbench::Film& b) {
  const std::vector<double> left = a.rgb();
  const std::vector<double> right = b.rgb();
  double brightest = 0;
  double largest = 0;
  for (std::size_t i = 0; i < left.size(); ++i) {
    brightest = std::max(brightest, left[i]);
    largest = std::max(largest, std::abs(left[i] - right[i]));
  }
  return largest / brightest;
}

struct Variation {
  const char* name;
  std::function<void(RenderOptions&)> apply;
};

std::vector<Variation> variations() {
  return {{"default", [](RenderOptions&) {}},
          {"sobol", [](RenderOptions& o) { o.program.sampler = path_tracer::Sampler::sobol; }},
          {"solid angle",
           [](RenderOptions& o) { o.program.light_sampling = path_tracer::LightSampling::solid_angle; }},
          {"every shadow ray", [](RenderOptions& o) { o.program.cull_shadow_rays = false; }},
          {"short paths", [](RenderOptions& o) { o.program.roulette_start = 0; }},
          {"long paths", [](RenderOptions& o) { o.program.roulette_start = 40; }},
          {"stride", [](RenderOptions& o) { o.program.pixel_stride = 5; }},
          {"later samples", [](RenderOptions& o) { o.work.first_sample = 7; }},
          {"one sample", [](RenderOptions& o) { o.work.samples = 1; }},
          {"8 PEs", [](RenderOptions& o) { o.chip.chip.pes = 8; }},
          {"256 PEs", [](RenderOptions& o) { o.chip.chip.pes = 256; }}};
}

class ResidentPaths : public test_support::SystemCFixture {
 protected:
  static RenderResult on_chip(const Scene& scene, const RenderOptions& options) {
    new_context();
    return testbench::render_on_chip(scene, options);
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

/// Two lights, one of them a lone triangle, and a box of squares.
Scene cube_with_two_lights() {
  Scene scene = test_support::closed_cube(0.6, 0.0, kFilm);
  scene.materials.push_back({"lamp", {0.2, 0.2, 0.2}, {3, 2, 1}});
  for (const std::size_t triangle : {0u, 1u, 6u})
    scene.triangles[triangle].material = int(scene.materials.size()) - 1;
  return scene;
}

void expect_same_paths(const RenderResult& resident, const RenderResult& binned) {
  EXPECT_EQ(resident.counts.paths, binned.counts.paths);
  EXPECT_EQ(resident.counts.segments, binned.counts.segments);
  EXPECT_EQ(resident.counts.shadow_rays, binned.counts.shadow_rays);
  EXPECT_EQ(resident.counts.culled_shadow_rays, binned.counts.culled_shadow_rays);
  EXPECT_EQ(resident.counts.paths_by_segments, binned.counts.paths_by_segments);
  EXPECT_LT(distance_of(resident.film, binned.film), 1e-14);
}

TEST_F(ResidentPaths, AreThePathsOfTheBins) {
  for (const Scene& scene : {test_support::small_cornell_box(kFilm), cube_with_two_lights()})
    for (const Variation& variation : variations()) {
      SCOPED_TRACE(variation.name);
      RenderOptions options = options_with(0);
      variation.apply(options);
      const RenderResult binned = testbench::render_natively(scene, options);
      options.program.resident_paths = 1;
      const RenderResult one = testbench::render_natively(scene, options);
      expect_same_paths(one, binned);
      options.program.resident_paths = 4;
      const RenderResult four = testbench::render_natively(scene, options);
      expect_same_paths(four, binned);
      EXPECT_EQ(four.film.sha256(), one.film.sha256());
    }
}

TEST_F(ResidentPaths, AreTheSameOnTheChipWithoutHazards) {
  const Scene scene = test_support::small_cornell_box(kFilm);
  for (const int paths : {1, 4}) {
    RenderOptions options = options_with(paths);
    const std::string film = testbench::render_natively(scene, options).film.sha256();
    options.check_hazards = true;
    const RenderResult checked = on_chip(scene, options);
    EXPECT_EQ(checked.film.sha256(), film);
    options.check_hazards = false;
    EXPECT_EQ(on_chip(scene, options).chip->firmware_cycles, checked.chip->firmware_cycles);
    options.timing = model::TimingStyle::approximately_timed;
    EXPECT_EQ(on_chip(scene, options).film.sha256(), film);
  }
}

/// On the paper's chip as tuned code sees it: nothing is loaded but the scene, so a call of a copy, which
/// costs thousands of cycles there, hardly counts, and what is left is computing.
TEST_F(ResidentPaths, AreTwentyTimesAsFastAsThePaper) {
  constexpr double kPaperSegmentsPerSecond = 1e6 / 13.28;
  const Scene scene = test_support::small_cornell_box({96, 96});
  RenderOptions options = options_with(4, 4);
  options.chip = model::preset("paper");
  options.chip.poly.code_quality_factor = 1;
  const RenderResult result = on_chip(scene, options);
  EXPECT_GT(double(result.counts.segments) / result.chip->seconds(), 20 * kPaperSegmentsPerSecond);
  EXPECT_EQ(result.chip->pio.requests_to_poly, 2u) << "surfaces and lights, once";
}

TEST_F(ResidentPaths, RefuseWhatTheyDoNotKnow) {
  const Scene plain = test_support::small_cornell_box(kFilm);
  const auto refused_with = [&](const Scene& scene, const std::function<void(RenderOptions&)>& apply) {
    RenderOptions options = options_with(4);
    apply(options);
    return refusal(scene, options);
  };
  EXPECT_EQ(refused_with(plain, [](RenderOptions& o) { o.program.program = Program::direct; }),
            "program: found direct, allowed is full with resident_paths 4");
  EXPECT_EQ(refused_with(plain, [](RenderOptions& o) { o.program.resident_paths = 3; }),
            "resident_paths: found 3, allowed is one of 0, 1, 4");
  EXPECT_EQ(
      refused_with(plain, [](RenderOptions& o) { o.program.traversal = path_tracer::Traversal::refill; }),
      "traversal: found refill, allowed is brute_force with resident_paths 4");
  const std::string listed = refused_with(plain, [](RenderOptions& o) {
    o.camera_samples = {{0, 0}, {3, 0}};
  });
  EXPECT_EQ(listed.find("resident_paths: found a list of samples; allowed with it are"), 0u) << listed;
  Scene sky = plain;
  sky.environment.constant = {1, 1, 1};
  const std::string lit = refused_with(sky, [](RenderOptions&) {});
  EXPECT_EQ(lit.find("resident_paths: found light that no triangle emits; allowed"), 0u) << lit;
  const std::string large = refused_with(test_support::closed_sphere(0.5, 1, 2, kFilm), [](auto&) {});
  EXPECT_NE(large.find("surfaces"), std::string::npos) << large;
}

}  // namespace resident_paths_test
