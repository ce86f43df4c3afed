// Whole renders of surfaces that do more than reflect diffusely, against closed forms and each other.

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "testbench/run/render.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/statistics.hpp"

namespace materials_render_test {

using path_tracer::Estimator;
using path_tracer::Program;
using path_tracer::Traversal;
using test_support::render_options;
using testbench::Film;
using testbench::Material;
using testbench::RenderOptions;
using testbench::Scene;

Material metal(double roughness) {
  Material material;
  material.reflectance = glm::dvec3(1.0);
  material.metallic = 1.0;
  material.specular = 1.0;
  material.roughness = roughness;
  return material;
}

Material plastic(double roughness) {
  Material material = metal(roughness);
  material.metallic = 0.0;
  return material;
}

Material glass(double roughness, double ior = 1.5) {
  Material material = plastic(roughness);
  material.transmission = 1.0;
  material.ior = ior;
  material.is_thin = false;
  return material;
}

Material coated() {
  Material material;
  material.reflectance = glm::dvec3(1.0);
  material.clearcoat = 1.0;
  material.clearcoat_roughness = 0.1;
  return material;
}

void add_square(Scene& scene, const glm::dvec3& corner, const glm::dvec3& edge1, const glm::dvec3& edge2,
                std::int32_t material) {
  scene.triangles.push_back({{corner, corner + edge1, corner + edge1 + edge2}, material});
  scene.triangles.push_back({{corner, corner + edge1 + edge2, corner + edge2}, material});
}

/// A closed box from -half to half, wound so that its outside is the front.
void add_box(Scene& scene, const glm::dvec3& half, std::int32_t material) {
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      glm::dvec3 corner = -half;
      corner[axis] = side * half[axis];
      glm::dvec3 edge1(0.0);
      glm::dvec3 edge2(0.0);
      edge1[(axis + 1) % 3] = 2 * half[(axis + 1) % 3];
      edge2[(axis + 2) % 3] = 2 * half[(axis + 2) % 3];
      if (side < 0) std::swap(edge1, edge2);
      add_square(scene, corner, edge1, edge2, material);
    }
}

/// The camera at z = 10 looks along -z at what is near the origin, and sees a piece of the side `width`.
Scene seen_from_afar(double width, testbench::FilmSize film) {
  Scene scene;
  scene.name = "materials";
  scene.film = film;
  scene.camera.position = {0.0, 0.0, 10.0};
  scene.camera.direction = {0.0, 0.0, -1.0};
  scene.camera.up = {0.0, 1.0, 0.0};
  scene.camera.vertical_field_of_view_radians = 2.0 * std::atan(0.5 * width / 10.0);
  return scene;
}

/// The sphere of the scene `sphere_under_light`, of another material.
Scene sphere_of(const Material& material, testbench::FilmSize film) {
  Scene scene = test_support::sphere_under_light(8, film);
  scene.materials.at(1) = material;
  return scene;
}

struct Mean {
  glm::dvec3 value{0.0};
  glm::dvec3 variance{0.0};
};

Mean mean_of(const Film& film) {
  Mean mean;
  const int pixels = film.size().width * film.size().height;
  for (int pixel = 0; pixel < pixels; ++pixel) {
    mean.value += film.mean(pixel) / double(pixels);
    mean.variance += film.variance_of_mean(pixel) / (double(pixels) * pixels);
  }
  return mean;
}

/// Numbers must be independent for the film's variances to mean anything.
RenderOptions independent(Program program, int samples) {
  RenderOptions options = render_options(program, samples);
  options.program.sampler = path_tracer::Sampler::philox;
  return options;
}

TEST(MaterialsRender, WhiteSurfacesVanishInAWhiteFurnace) {
  struct Case {
    const char* name;
    Material material;
    double least;  ///< of the light that is kept, docs/materials.md
    double most;
  };
  Material white;
  white.reflectance = glm::dvec3(1.0);
  const Case cases[] = {{"diffuse", white, 1.0, 1.0},          {"mirror", metal(0.0), 1.0, 1.0},
                        {"metal", metal(0.5), 0.99, 1.01},     {"plastic", plastic(0.4), 0.99, 1.01},
                        {"glass", glass(0.0), 0.9999, 1.0001}, {"coat", coated(), 0.94, 1.01}};
  for (const Case& of : cases) {
    Scene scene = seen_from_afar(1.5, {12, 12});
    scene.materials = {of.material};
    scene.environment.constant = glm::dvec3(1.0);
    add_box(scene, {0.5, 0.4, 0.5}, 0);
    const Mean mean = mean_of(render_natively(scene, independent(Program::full, 256)).film);
    const double error = 5 * std::sqrt(mean.variance.x) + 1e-6;
    EXPECT_GT(mean.value.x + error, of.least) << of.name;
    EXPECT_LT(mean.value.x - error, of.most) << of.name;
  }
}

/// At normal incidence a slab passes (1 - F)^2 / (1 - F^2) = (1 - F) / (1 + F) of the light behind it, with F
/// = 0.04, after any number of reflections within.
TEST(MaterialsRender, ASlabPassesWhatFresnelSays) {
  Scene scene = seen_from_afar(0.01, {4, 4});
  Material light;
  light.emission = glm::dvec3(1.0);
  scene.materials = {glass(0.0), light};
  add_box(scene, {5.0, 5.0, 0.25}, 0);
  add_square(scene, {-50, -50, -20}, {100, 0, 0}, {0, 100, 0}, 1);
  for (const Program program : {Program::segments, Program::full}) {
    const Mean mean = mean_of(render_natively(scene, independent(program, 4096)).film);
    EXPECT_NEAR(mean.value.x, 0.96 / 1.04, 5 * std::sqrt(mean.variance.x)) << int(program);
  }
}

/// Without a difference of indices nothing is reflected or bent, and Beer's and Lambert's law is left.
TEST(MaterialsRender, ABodyAbsorbsByItsDepth) {
  Material body = glass(0.0, 1.0);
  body.specular = 0.0;
  body.attenuation_colour = {0.5, 0.25, 1.0};
  body.attenuation_distance = 2.0;
  Scene scene = seen_from_afar(0.001, {4, 4});
  scene.materials = {body};
  scene.environment.constant = glm::dvec3(1.0);
  add_box(scene, {5.0, 5.0, 1.5}, 0);  // three units deep
  RenderOptions options = independent(Program::full, 16);
  options.program.roulette_start = 8;
  const Mean mean = mean_of(render_natively(scene, options).film);
  EXPECT_NEAR(mean.value.x, std::pow(0.5, 1.5), 1e-9);
  EXPECT_NEAR(mean.value.y, std::pow(0.25, 1.5), 1e-9);
  EXPECT_NEAR(mean.value.z, 1.0, 1e-9);
}

/// At normal incidence a smooth dielectric reflects what its colour says, channel by channel, at most 1.
TEST(MaterialsRender, VarnishReflectsItsColour) {
  Material varnish = plastic(0.0);
  varnish.reflectance = glm::dvec3(0.0);
  varnish.specular_colour = {1.0, 0.25, 30.0};
  varnish.specular = 0.75;
  Scene scene = seen_from_afar(0.0001, {4, 4});
  scene.materials = {varnish};
  scene.environment.constant = glm::dvec3(1.0);
  add_square(scene, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 0);
  RenderOptions options = independent(Program::full, 4);
  options.program.roulette_start = 8;
  const Mean mean = mean_of(render_natively(scene, options).film);
  EXPECT_NEAR(mean.value.x, 0.75 * 0.04, 1e-9);
  EXPECT_NEAR(mean.value.y, 0.75 * 0.01, 1e-9);
  EXPECT_NEAR(mean.value.z, 0.75, 1e-9);
}

/// A sheet of which half passes light in a colour of its own, the other half reflects the base colour; a
/// square beside it passes its base colour.
TEST(MaterialsRender, WhatPassesHasItsOwnColour) {
  Material sheet = glass(0.0, 1.0);
  sheet.is_thin = true;
  sheet.specular = 0.0;
  sheet.transmission = 0.5;
  sheet.reflectance = {0.9, 0.5, 0.1};
  sheet.transmission_colour = {0.1, 0.5, 1.0};
  Material other = sheet;
  other.transmission_colour = other.reflectance;
  Scene scene = seen_from_afar(1.0, {8, 8});
  scene.materials = {sheet, other};
  scene.environment.constant = glm::dvec3(1.0);
  add_square(scene, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 0);
  add_square(scene, {5, -1, 0}, {2, 0, 0}, {0, 2, 0}, 1);
  for (const glm::dvec3& expected : {glm::dvec3(0.5, 0.5, 0.55), glm::dvec3(0.9, 0.5, 0.1)}) {
    const Mean mean = mean_of(render_natively(scene, independent(Program::full, 1024)).film);
    for (int channel = 0; channel < 3; ++channel)
      EXPECT_NEAR(mean.value[channel], expected[channel], 5 * std::sqrt(mean.variance[channel]) + 1e-9);
    scene.camera.position.x = 6.0;
  }
}

/// Of the directions around a normal that leans by `angle` from the triangle's, (1 + cos(angle)) / 2 by
/// weight lie above the triangle; the others get no light.
TEST(MaterialsRender, NormalsOfCornersTurnTheShading) {
  const double angle = 0.6;
  Scene scene = seen_from_afar(0.5, {8, 8});
  Material grey;
  grey.reflectance = glm::dvec3(0.5);
  scene.materials = {grey};
  scene.environment.constant = glm::dvec3(1.0);
  add_square(scene, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 0);
  const glm::dvec3 leaning{std::sin(angle), 0.0, std::cos(angle)};
  scene.corners.normals.assign(2, {leaning, leaning, leaning});
  const Mean mean = mean_of(render_natively(scene, independent(Program::full, 1024)).film);
  EXPECT_NEAR(mean.value.x, 0.5 * 0.5 * (1.0 + std::cos(angle)), 5 * std::sqrt(mean.variance.x));
}

/// Within a body, direct light fades on its way to the viewer as all other light does: shadow rays and hits
/// agree.
TEST(MaterialsRender, DirectLightFadesInABody) {
  Material body = glass(0.0, 1.0);
  body.specular = 0.0;
  body.transmission = 0.5;  // the other half is reflected diffusely
  body.attenuation_colour = {0.5, 0.25, 1.0};
  body.attenuation_distance = 1.0;
  Material light;
  light.emission = glm::dvec3(1.0);
  Scene scene = seen_from_afar(2.0, {8, 8});
  scene.materials = {body, light};
  add_box(scene, {20.0, 20.0, 11.0}, 0);  // the camera is in it, one unit from the wall behind
  scene.camera.direction = {0.0, 0.0, 1.0};
  add_square(scene, {-2, -2, 9}, {4, 0, 0}, {0, 4, 0}, 1);  // behind the camera, faces the wall
  const Mean by_hits = mean_of(render_natively(scene, independent(Program::segments, 4096)).film);
  const Mean by_rays = mean_of(render_natively(scene, independent(Program::full, 1024)).film);
  for (int channel = 0; channel < 3; ++channel)
    EXPECT_NEAR(by_rays.value[channel], by_hits.value[channel],
                5 * std::sqrt(by_hits.variance[channel] + by_rays.variance[channel]));
  EXPECT_LT(by_rays.value.y, 0.6 * by_rays.value.x);
}

/// By hits, by shadow rays and by both: the same light.
TEST(MaterialsRender, EstimatorsAgree) {
  struct Case {
    const char* name;
    Material material;
  };
  Material gold = metal(0.3);
  gold.reflectance = {0.8, 0.6, 0.3};
  Material red = plastic(0.2);
  red.reflectance = {0.8, 0.2, 0.2};
  Material tinted = glass(0.4);
  tinted.specular_colour = {1.0, 5.0, 2.0};
  tinted.transmission = 0.5;
  tinted.transmission_colour = {0.3, 0.9, 0.6};
  const Case cases[] = {{"tinted", tinted},    {"gold", gold},          {"red", red},
                        {"glass", glass(0.0)}, {"frosted", glass(0.4)}, {"mirror", metal(0.0)},
                        {"coat", coated()}};
  for (const Case& of : cases) {
    const Scene scene = sphere_of(of.material, {16, 16});
    const Mean by_hits = mean_of(render_natively(scene, independent(Program::segments, 1024)).film);
    for (const Estimator estimator : {Estimator::light, Estimator::mis, Estimator::per_lobe}) {
      RenderOptions options = independent(Program::full, 512);
      options.program.estimator = estimator;
      const Mean mean = mean_of(render_natively(scene, options).film);
      for (int channel = 0; channel < 3; ++channel) {
        const double deviation = std::sqrt(by_hits.variance[channel] + mean.variance[channel]);
        EXPECT_NEAR(mean.value[channel], by_hits.value[channel], 5 * deviation)
            << of.name << " " << int(estimator);
      }
    }
  }
}

TEST(MaterialsRender, TheImageIsTheSameHoweverItIsMade) {
  Scene scene = sphere_of(glass(0.4), {12, 12});
  scene.materials.at(0).clearcoat = 1.0;
  scene.materials.at(0).clearcoat_roughness = 0.3;
  const std::vector<double> expected = render_natively(scene, render_options(Program::full, 4)).film.rgb();
  for (const Traversal traversal : {Traversal::brute_force, Traversal::temporary_bin, Traversal::refill,
                                    Traversal::lock_step, Traversal::packets, Traversal::shared_treelets}) {
    for (const int n : {0, 2}) {
      RenderOptions options = render_options(Program::full, 4);
      options.program.traversal = traversal;
      options.program.n = n;
      options.program.tree.resident_nodes = 1;  // so that all ways fit beside the records with tails
      options.program.tree.stack_entries = 2;
      options.program.tree.treelet_nodes = 1;
      options.chip.chip.pes = n == 0 ? 96 : 32;
      EXPECT_EQ(render_natively(scene, options).film.rgb(), expected) << int(traversal) << " " << n;
    }
  }
}

TEST(MaterialsRender, TheChipFindsWhatTheNativeMachineFindsWithoutHazards) {
  const Scene scene = sphere_of(plastic(0.3), {8, 8});
  RenderOptions options = render_options(Program::full, 2);
  options.program.n = 2;
  const std::vector<double> expected = render_natively(scene, options).film.rgb();
  options.check_hazards = true;
  EXPECT_EQ(render_on_chip(scene, options).film.rgb(), expected);
}

/// What a scene lacks costs nothing: diffuse scenes run the kernel `scatter` on records without tails.
TEST(MaterialsRender, DiffuseScenesPayNothing) {
  const Scene scene = test_support::sphere_under_light(4, {8, 8});
  const RenderOptions options = render_options(Program::full, 2);
  const testbench::MonoImage image = testbench::make_mono_image(scene, 96, options.program);
  EXPECT_TRUE(image.layout.features.plain());
  EXPECT_EQ(image.layout.sizes.surface, int{sizeof(path_tracer::SurfaceRecord)});
  EXPECT_EQ(image.layout.sizes.hit, int{sizeof(path_tracer::HitRecord)});
  Scene shiny = scene;
  shiny.materials.at(1) = plastic(0.3);
  const testbench::MonoImage with_tails = testbench::make_mono_image(shiny, 96, options.program);
  EXPECT_FALSE(with_tails.layout.features.plain());
  EXPECT_FALSE(with_tails.layout.features.lobes.coat);
  EXPECT_FALSE(with_tails.layout.features.lobes.varnish_tint);
  EXPECT_FALSE(with_tails.layout.features.lobes.transmission_tint);
  EXPECT_GT(with_tails.layout.sizes.surface, image.layout.sizes.surface);
}

}  // namespace materials_render_test
