// Hits that wait in bins of their kind: the same image, fewer lobes issued.

#include <gtest/gtest.h>

#include <string>

#include "testbench/mono_image/shading_kinds.hpp"
#include "testbench/run/render.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"

namespace shading_bins_test {

using path_tracer::Program;
using path_tracer::Shading;
using path_tracer::Traversal;
using test_support::render_options;
using testbench::Material;
using testbench::RenderOptions;
using testbench::Scene;

constexpr Shading kShadings[] = {Shading::every_lobe, Shading::present_lobes, Shading::material_bins,
                                 Shading::texture_bins};

Material metal() {
  Material material;
  material.reflectance = {0.9, 0.7, 0.4};
  material.metallic = 1.0;
  material.roughness = 0.3;
  return material;
}

Material glass() {
  Material material;
  material.reflectance = glm::dvec3(1.0);
  material.specular = 1.0;
  material.roughness = 0.0;
  material.transmission = 1.0;
  return material;
}

Material coated() {
  Material material;
  material.reflectance = {0.2, 0.3, 0.6};
  material.clearcoat = 1.0;
  material.clearcoat_roughness = 0.1;
  return material;
}

/// Random triangles of four materials before an environment, so that a block holds hits of all of them,
/// misses and shadow rays.
Scene many_materials() {
  Scene scene = test_support::triangle_soup(60, 7, {24, 20});
  const auto first = static_cast<std::int32_t>(scene.materials.size());
  for (const Material& material : {metal(), glass(), coated()}) scene.materials.push_back(material);
  for (std::size_t i = 0; i < scene.triangles.size(); ++i)
    if (i % 4 != 0 && scene.materials[std::size_t(scene.triangles[i].material)].emission == glm::dvec3(0.0))
      scene.triangles[i].material = first + static_cast<std::int32_t>(i % 4) - 1;
  scene.environment.constant = glm::dvec3(0.2);
  return scene;
}

/// A floor with two textures of the same lobes.
Scene two_textures() {
  Scene scene = test_support::sphere_under_light(2, {16, 16});
  for (int i = 0; i < 2; ++i) {
    scene.textures.push_back(test_support::random_texture(8, 8, 3, testbench::TexelEncoding::srgb));
    Material material;
    material.reflectance = glm::dvec3(1.0);
    material.textures.reflectance.texture = i;
    scene.materials.push_back(material);
    const double x = i == 0 ? -1.0 : 0.0;
    test_support::add_textured_square(scene,
                                      {{{x, -0.9, 1}, {x + 1, -0.9, 1}, {x + 1, -0.9, -1}, {x, -0.9, -1}}},
                                      static_cast<std::int32_t>(scene.materials.size()) - 1);
  }
  return scene;
}

std::string image_of(const Scene& scene, const RenderOptions& options) {
  return render_natively(scene, options).film.sha256();
}

TEST(ShadingBins, TheImageIsTheSameHoweverHitsAreBinned) {
  for (const Scene& scene : {many_materials(), two_textures()}) {
    const RenderOptions plain = render_options(Program::full, 3);
    const std::string expected = image_of(scene, plain);
    for (const Shading shading : kShadings)
      for (const Traversal traversal :
           {Traversal::brute_force, Traversal::refill, Traversal::shared_treelets})
        for (const int n : {0, 1, 2}) {
          RenderOptions options = plain;
          options.program.shading = shading;
          options.program.traversal = traversal;
          options.program.n = n;
          options.program.bin_blocks = 3 + n;
          options.program.tree.resident_nodes = 1;  // so that all ways fit
          options.program.tree.stack_entries = 2;
          options.program.tree.treelet_nodes = 1;
          EXPECT_EQ(image_of(scene, options), expected)
              << name_of(shading) << ", " << name_of(traversal) << ", n " << n;
        }
  }
}

TEST(ShadingBins, LightThatHitsFindIsTheSame) {
  const Scene scene = many_materials();
  RenderOptions options = render_options(Program::segments, 3);
  const std::string expected = image_of(scene, options);
  options.program.shading = Shading::material_bins;
  EXPECT_EQ(image_of(scene, options), expected);
}

TEST(ShadingBins, PlainScenesHaveOneKindOfMaterial) {
  const Scene scene = test_support::small_cornell_box({16, 16});
  RenderOptions options = render_options(Program::full, 2);
  const std::string expected = image_of(scene, options);
  options.program.shading = Shading::material_bins;
  EXPECT_EQ(image_of(scene, options), expected);
}

TEST(ShadingBins, TheChipFindsWhatTheNativeMachineFindsWithoutHazards) {
  const Scene scene = many_materials();
  RenderOptions options = render_options(Program::full, 4);
  options.program.n = 2;
  const std::string expected = image_of(scene, options);
  options.check_hazards = true;
  options.program.shading = Shading::material_bins;
  EXPECT_EQ(render_on_chip(scene, options).film.sha256(), expected);
}

TEST(ShadingBins, KindsAreToldApartByLobesAndByTextures) {
  const Scene scene = two_textures();
  const std::vector<std::int32_t> by_lobes = shading_kinds(scene, scene.materials, Shading::material_bins);
  const std::vector<std::int32_t> by_textures = shading_kinds(scene, scene.materials, Shading::texture_bins);
  const std::size_t last = scene.materials.size() - 1;
  EXPECT_EQ(by_lobes[last], by_lobes[last - 1]);
  EXPECT_NE(by_textures[last], by_textures[last - 1]);
  const Scene many = many_materials();
  const std::vector<std::int32_t> of_many = shading_kinds(many, many.materials, Shading::material_bins);
  const std::size_t metal_at = many.materials.size() - 3;
  EXPECT_NE(of_many[metal_at], of_many[metal_at + 1]);
  EXPECT_NE(of_many[metal_at], of_many[metal_at + 2]);
}

}  // namespace shading_bins_test
