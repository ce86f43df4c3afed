// Bidirectional paths: the same means as paths from the lens alone and as closed forms, the same bits however
// they are computed.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "firmware/path_tracer/program/program_options.hpp"
#include "testbench/film/image_agreement.hpp"
#include "testbench/run/render.hpp"
#include "testbench/run/traversal_choice.hpp"
#include "testbench/sampling/sample_counts.hpp"
#include "testbench/scene_file/scene_file.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/systemc_fixture.hpp"

namespace bidirectional_test {

using path_tracer::Paths;
using path_tracer::Program;
using test_support::render_options;
using testbench::Film;
using testbench::FilmSize;
using testbench::Light;
using testbench::LightKind;
using testbench::Material;
using testbench::RenderOptions;
using testbench::RenderResult;
using testbench::Scene;

constexpr double kPi = 3.14159265358979323846;

/// Random numbers are independent, so that films know their own variance.
RenderOptions options_of(Paths paths, int samples) {
  RenderOptions options = render_options(Program::full, samples);
  options.program.paths = paths;
  options.program.seed = paths == Paths::bidirectional ? 2 : 1;
  options.program.light_sampling = path_tracer::LightSampling::solid_angle;
  options.program.roulette_start = 3;
  return options;
}

Scene shipped(const std::string& name, FilmSize film) {
  Scene scene = testbench::load_scene(std::string(CSX600_SCENES_DIR) + "/" + name);
  scene.film = film;
  return scene;
}

/// Turns the camera down, until it sees no lamp, whose edges would be most of the noise.
Scene without_lamps(Scene scene) {
  constexpr double kDown = 0.35;
  testbench::Camera& camera = scene.camera;
  const glm::dvec3 up = camera.up;
  camera.up = glm::normalize(up + kDown * camera.direction);
  camera.direction = glm::normalize(camera.direction - kDown * up);
  return scene;
}

void expect_agreement(const Scene& scene, int samples, int light_vertices = 4) {
  RenderOptions both = options_of(Paths::bidirectional, samples);
  both.program.light_vertices = light_vertices;
  RenderOptions one = options_of(Paths::unidirectional, 4 * samples);
  testbench::search_natively(both);
  testbench::search_natively(one);
  const Film from_both = render_natively(scene, both).film;
  const testbench::ImageAgreement agreement = agreement_of(render_natively(scene, one).film, from_both);
  EXPECT_TRUE(agreement.holds()) << scene.name << ", " << light_vertices << " light vertices\n"
                                 << agreement.text();
}

TEST(Bidirectional, AgreesWithPathsFromTheLensInTheCornellBox) {
  for (const int light_vertices : {1, 2, 5})
    expect_agreement(without_lamps(shipped("cornell_box", {24, 24})), 256, light_vertices);
}

TEST(Bidirectional, AgreesInParallelRays) {
  Scene scene = without_lamps(shipped("cornell_box", {24, 24}));
  scene.camera.orthographic_height = 500;
  expect_agreement(scene, 256);
}

TEST(Bidirectional, AgreesOnEveryMaterial) {
  for (const char* const name : {"glossy", "glass", "materials", "uplight"})
    expect_agreement(without_lamps(shipped(name, {24, 24})), 256);
}

TEST(Bidirectional, AgreesUnderASky) {
  for (const char* const name : {"environment", "outdoors"}) expect_agreement(shipped(name, {24, 24}), 256);
}

Light near_light(LightKind kind, const glm::dvec3& position) {
  Light light;
  light.kind = kind;
  light.position = position;
  light.direction = {0, -1, 0};
  light.intensity = glm::dvec3(3e4, 2e4, 1e4);
  light.inner_cone_radians = 0.4;
  light.outer_cone_radians = 0.9;
  return light;
}

TEST(Bidirectional, AgreesUnderPointsSpotsAndParallelLight) {
  Scene scene = without_lamps(shipped("cornell_box", {24, 24}));
  scene.lights = {near_light(LightKind::point, {150, 300, 200}),
                  near_light(LightKind::spot, {400, 500, 300})};
  Light parallel;
  parallel.kind = LightKind::sun;
  parallel.direction = glm::normalize(glm::dvec3(0.3, -0.5, 1));
  parallel.intensity = glm::dvec3(2, 3, 4);
  scene.lights.push_back(parallel);
  expect_agreement(scene, 256);
}

Light sun_with_a_disk() {
  Light sun;
  sun.kind = LightKind::sun;
  sun.direction = glm::normalize(glm::dvec3(-0.6, -0.7, -0.3));
  sun.intensity = glm::dvec3(3, 2.8, 2.4);
  sun.angular_diameter_radians = 0.3;
  return sun;
}

/// Every surface but the walls lets a part of the rays through, the lamp too.
Scene half_there(Scene scene) {
  for (Material& material : scene.materials) {
    if (material.emission == glm::dvec3(0) && material.reflectance.x == material.reflectance.y) continue;
    material.alpha_mode = testbench::AlphaMode::blend;
    material.alpha = 0.5;
  }
  return scene;
}

TEST(Bidirectional, AgreesThroughSurfacesThatLetRaysPass) {
  expect_agreement(shipped("textured", {24, 24}), 256);
  for (const int light_vertices : {1, 4})
    expect_agreement(half_there(without_lamps(shipped("cornell_box", {24, 24}))), 256, light_vertices);
  Scene under_a_sun = shipped("textured", {24, 24});
  under_a_sun.lights.push_back(sun_with_a_disk());
  expect_agreement(under_a_sun, 256);
}

TEST(Bidirectional, AgreesUnderALightWithATexture) {
  expect_agreement(test_support::textured_squares({24, 24}, true), 256);
}

/// Mirrors and glass show the disk, and throw its light on what is around.
TEST(Bidirectional, AgreesUnderADiskBesideGlass) {
  Scene scene = shipped("outdoors", {24, 24});
  scene.lights = {sun_with_a_disk()};
  scene.materials.back().transmission = 1;
  scene.materials.back().roughness = 0;
  scene.materials.back().ior = 1.5;
  scene.materials.back().specular = 1;
  expect_agreement(scene, 256);
}

double mean_of(const Film& film, double& error) {
  double mean = 0;
  double variance = 0;
  for (int pixel = 0; pixel < film.pixel_count(); ++pixel) {
    mean += film.mean(pixel).x / film.pixel_count();
    variance += film.variance_of_mean(pixel).x / (double(film.pixel_count()) * film.pixel_count());
  }
  error = std::sqrt(variance);
  return mean;
}

void expect_mean(const Scene& scene, int samples, double expected) {
  for (const int light_vertices : {1, 4}) {
    RenderOptions options = options_of(Paths::bidirectional, samples);
    options.program.light_vertices = light_vertices;
    double error = 0;
    const double mean = mean_of(render_natively(scene, options).film, error);
    EXPECT_LT(error, 2e-3 * expected) << "too few samples to tell";
    EXPECT_LT(std::abs(mean - expected), 4 * error) << mean << ", expected is " << expected;
  }
}

/// Everything emits 0.2 and reflects 0.8: 0.2 / (1 - 0.8).
TEST(Bidirectional, AFurnaceIsOneEverywhere) {
  expect_mean(test_support::closed_cube(0.8, 0.2, {16, 16}), 512, 1);
}

/// Two unit squares face each other at the distance 1 (Howell's catalogue of configuration factors, C-11).
TEST(Bidirectional, OpposedSquaresHaveTheirConfigurationFactor) {
  Scene scene;
  scene.name = "opposed squares";
  scene.film = {16, 16};
  scene.camera.position = {0.5, 0.5, 0.5};
  scene.camera.direction = {0, -1, 0};
  scene.camera.up = {0, 0, 1};
  scene.camera.orthographic_height = 1;
  scene.materials.resize(2);
  scene.materials[0].reflectance = glm::dvec3(0.5);
  scene.materials[1].emission = glm::dvec3(1);
  const auto add_square = [&](const std::array<glm::dvec3, 4>& corners, std::int32_t material) {
    scene.triangles.push_back({{corners[0], corners[1], corners[2]}, material});
    scene.triangles.push_back({{corners[0], corners[2], corners[3]}, material});
  };
  add_square({{{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}}, 0);
  add_square({{{0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}}}, 1);
  expect_mean(scene, 1024, 0.5 * 0.199824896);
}

using Change = std::function<void(RenderOptions&)>;

void expect_same_bits(const Scene& scene, const std::vector<Change>& changes) {
  const RenderOptions options = options_of(Paths::bidirectional, 2);
  const std::string expected = render_natively(scene, options).film.sha256();
  for (std::size_t i = 0; i < changes.size(); ++i) {
    RenderOptions changed = options;
    changes[i](changed);
    EXPECT_EQ(render_natively(scene, changed).film.sha256(), expected) << scene.name << ", change " << i;
  }
}

TEST(Bidirectional, GivesTheSameBitsHoweverItIsComputed) {
  const Change without_buffering = [](RenderOptions& of) { of.program.n = 0; };
  const Change with_short_bins = [](RenderOptions& of) { of.program.bin_blocks = 3; };
  const Change on_few_pes = [](RenderOptions& of) { of.chip.chip.pes = 32; };
  const Change with_stride = [](RenderOptions& of) { of.program.pixel_stride = 7; };
  const Change through_the_simulators_tree = [](RenderOptions& of) { testbench::search_natively(of); };
  const Change with_every_lobe = [](RenderOptions& of) {
    of.program.shading = path_tracer::Shading::every_lobe;
  };
  const Change with_hazards_checked = [](RenderOptions& of) {
    of.program.bin_blocks = 4;
    of.check_hazards = true;
  };
  expect_same_bits(shipped("glass", {12, 10}),
                   {without_buffering, with_short_bins, on_few_pes, with_stride, through_the_simulators_tree,
                    with_every_lobe, with_hazards_checked});
  expect_same_bits(shipped("textured", {12, 10}),
                   {without_buffering, with_short_bins, on_few_pes, with_stride, through_the_simulators_tree,
                    with_every_lobe, with_hazards_checked});
  const Change twice_buffered = [](RenderOptions& of) { of.program.n = 2; };
  expect_same_bits(shipped("cornell_box", {12, 10}),
                   {without_buffering, twice_buffered, on_few_pes, with_hazards_checked});
}

TEST(Bidirectional, GivesTheSameBitsByEveryTraversal) {
  const Scene scene = shipped("cornell_box", {12, 10});
  const RenderOptions options = options_of(Paths::bidirectional, 2);
  const std::string expected = render_natively(scene, options).film.sha256();
  for (const path_tracer::Traversal traversal :
       {path_tracer::Traversal::temporary_bin, path_tracer::Traversal::refill,
        path_tracer::Traversal::lock_step, path_tracer::Traversal::packets,
        path_tracer::Traversal::shared_treelets, path_tracer::Traversal::ray_unit}) {
    RenderOptions changed = options;
    changed.chip.search_unit.units = 1;
    changed.program.traversal = traversal;
    changed.program.bin_blocks = 4;
    testbench::choose_tree(testbench::TriangleCount(scene), changed.chip, {"traversal"}, changed.program);
    EXPECT_EQ(render_natively(scene, changed).film.sha256(), expected) << path_tracer::name_of(traversal);
  }
}

TEST(Bidirectional, AddsUpFromPartsOfTheWork) {
  const Scene scene = shipped("cornell_box", {9, 7});
  RenderOptions options = options_of(Paths::bidirectional, 6);
  const Film whole = render_natively(scene, options).film;
  options.work = {0, 2};
  Film parts = render_natively(scene, options).film;
  options.work = {2, 4};
  parts.merge(render_natively(scene, options).film);
  EXPECT_EQ(parts.sha256(), whole.sha256());
  const Film sent =
      Film::from_bytes(whole.size(), whole.scale(), testbench::FilmSums::means_and_variances, whole.bytes());
  EXPECT_EQ(sent.sha256(), whole.sha256());
  EXPECT_EQ(sent.variance_of_mean(20), whole.variance_of_mean(20));
}

/// From 16 to 256 samples a pixel, most of them at the right: light paths begin where no one looks at what
/// they bring.
testbench::SampleCounts uneven_counts(FilmSize film) {
  testbench::SampleCounts counts;
  for (int row = 0; row < film.height; ++row)
    for (int column = 0; column < film.width; ++column)
      counts.push_back(16 + 240 * std::int32_t(column * column) / std::int32_t(film.width * film.width));
  return counts;
}

Film listed(const Scene& scene, const testbench::SampleCounts& first, const testbench::SampleCounts& last) {
  RenderOptions options = options_of(Paths::bidirectional, 256);
  options.camera_samples = testbench::list_samples(first, last, options.program.pixel_stride);
  testbench::search_natively(options);
  return render_natively(scene, options).film;
}

TEST(Bidirectional, HasTheSameMeanWithUnevenNumbersOfSamples) {
  for (const char* const name : {"uplight", "cornell_box"}) {
    const Scene scene = without_lamps(shipped(name, {24, 24}));
    const testbench::SampleCounts counts = uneven_counts(scene.film);
    const testbench::SampleCounts none(counts.size(), 0);
    const Film film = listed(scene, none, counts);
    RenderOptions one = options_of(Paths::unidirectional, 1024);
    testbench::search_natively(one);
    const testbench::ImageAgreement agreement = agreement_of(render_natively(scene, one).film, film);
    EXPECT_TRUE(agreement.holds()) << name << "\n" << agreement.text();
    const testbench::SampleCounts first(counts.size(), 16);
    Film passes = listed(scene, none, first);
    passes.merge(listed(scene, first, counts));
    EXPECT_EQ(passes.sha256(), film.sha256()) << name << ": two passes are one";
  }
}

/// Splats divided by the pixel's own number of samples would be bright where it is small.
TEST(Bidirectional, AFurnaceIsOneWithUnevenNumbersOfSamples) {
  const Scene scene = test_support::closed_cube(0.8, 0.2, {16, 16});
  testbench::SampleCounts counts = uneven_counts(scene.film);
  for (auto& count : counts) count *= 4;
  double error = 0;
  const double mean = mean_of(listed(scene, testbench::SampleCounts(counts.size(), 0), counts), error);
  EXPECT_LT(error, 4e-3) << "too few samples to tell";
  EXPECT_LT(std::abs(mean - 1), 4 * error) << mean;
}

TEST(Bidirectional, CountsItsConnections) {
  const Scene scene = shipped("cornell_box", {16, 16});
  const RenderResult result = render_natively(scene, options_of(Paths::bidirectional, 4));
  const path_tracer::ConnectionCounts& of = result.counts.connections;
  EXPECT_EQ(result.counts.paths, 16u * 16u * 4u);
  EXPECT_GT(of.to_lens, 0u);
  EXPECT_GT(of.to_lights, 0u);
  EXPECT_GT(of.to_light_vertices, of.to_lights);
  EXPECT_EQ(of.all(), result.counts.shadow_rays);
  EXPECT_GT(of.light_segments, result.counts.paths);
  EXPECT_GT(result.counts.segments, of.light_segments);
}

class BidirectionalOnTheChip : public test_support::SystemCFixture {};

TEST_F(BidirectionalOnTheChip, GivesTheNativeImage) {
  const Scene scene = shipped("cornell_box", {12, 10});
  RenderOptions options = options_of(Paths::bidirectional, 2);
  const std::string expected = render_natively(scene, options).film.sha256();
  const RenderResult result = render_on_chip(scene, options);
  EXPECT_EQ(result.film.sha256(), expected);
  EXPECT_GT(result.chip->total_cycles, 0u);
}

void expect_refusal(const Scene& scene, const Change& change, const std::vector<std::string>& parts) {
  RenderOptions options = options_of(Paths::bidirectional, 1);
  change(options);
  test_support::expect_input_error([&] { render_natively(scene, options); }, parts);
}

TEST(Bidirectional, RefusesWhatItCannotDoInOneLine) {
  const Scene box = shipped("cornell_box", {4, 4});
  expect_refusal(box, [](RenderOptions& of) { of.program.program = Program::direct; },
                 {"program: found direct", "full with paths bidirectional"});
  expect_refusal(box, [](RenderOptions& of) { of.program.shading = path_tracer::Shading::material_bins; },
                 {"shading: found material_bins"});
  expect_refusal(box, [](RenderOptions& of) { of.program.light_candidates = 8; },
                 {"light_candidates: found 8"});
  expect_refusal(box, [](RenderOptions& of) { of.program.light_vertices = 17; },
                 {"light_vertices: found 17", "from 1 to 16"});
}

}  // namespace bidirectional_test
