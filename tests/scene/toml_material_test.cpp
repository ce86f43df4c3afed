// Materials, environments and lights of scene.toml.

#include "testbench/scene_file/toml_material.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "testbench/scene_file/save_scene.hpp"
#include "testbench/scene_file/scene_file.hpp"
#include "testbench/texture/sample.hpp"
#include "tests/support/image_bytes.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/temporary_directory.hpp"

namespace toml_material_test {

using testbench::AlphaMode;
using testbench::LightKind;
using testbench::Material;
using testbench::Scene;

class TomlMaterialTest : public test_support::DirectoryFixture {
 protected:
  /// The path of a scene.toml with one triangle of this material, which emits, and further tables.
  std::filesystem::path scene_file(const std::string& material, const std::string& tables = "") {
    write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n");
    return write("scene.toml",
                 "[camera]\nposition = [0, 0, 9]\nlook_at = [0, 0, 0]\nvertical_fov_degrees = 40\n"
                 "[[mesh]]\nfile = \"m.obj\"\nmaterial = {" +
                     material + "}\n" + tables);
  }
  Scene load(const std::string& material, const std::string& tables = "") {
    return testbench::load_scene(
        scene_file(material + (material.empty() ? "" : ", ") + "emission = [1, 1, 1]", tables));
  }
  Material material(const std::string& keys) { return load(keys).materials.at(0); }
  void expect_error(const std::string& keys, const std::vector<std::string>& parts) {
    test_support::expect_input_error([&] { load(keys); }, parts);
  }
  void expect_table_error(const std::string& tables, const std::vector<std::string>& parts) {
    std::vector<std::string> all = parts;
    all.insert(all.end(), {"scene.toml", "found ", "; allowed: "});
    test_support::expect_input_error([&] { load("", tables); }, all);
  }
};

TEST_F(TomlMaterialTest, EveryNumberAndColourHasItsRange) {
  for (const testbench::MaterialKey& key : testbench::material_keys()) {
    SCOPED_TRACE(key.name);
    const bool is_emission = key.colour == &Material::emission;
    const auto load_with = [&](double value) {
      std::ostringstream text;
      text.precision(17);
      text << key.name << " = ";
      if (key.colour != nullptr)
        text << "[" << value << ", " << value << ", " << value << "]";
      else
        text << value;
      return testbench::load_scene(scene_file(text.str() + (is_emission ? "" : ", emission = [1, 1, 1]")))
          .materials.at(0);
    };
    if (key.number != nullptr) {
      EXPECT_EQ(load_with(key.least).*key.number, key.least);
      EXPECT_EQ(load_with(key.most).*key.number, key.most);
    }
    if (key.colour != nullptr) {
      EXPECT_EQ(load_with(key.most).*key.colour, glm::dvec3(key.most));
    }
    if (key.number == nullptr && key.colour == nullptr) continue;
    for (const double value : {key.most * 1.01 + 1e-9, key.least - 1.0 - std::abs(key.least) * 0.01})
      test_support::expect_input_error([&] { load_with(value); },
                                       {"scene.toml:7", "mesh.material." + std::string(key.name)});
  }
}

TEST_F(TomlMaterialTest, KeysThatAreMissingKeepASurfaceDiffuse) {
  EXPECT_TRUE(testbench::is_plain(material("")));
  EXPECT_TRUE(testbench::is_plain(material("reflectance = [0.5, 0.5, 0.5]")));
  EXPECT_EQ(material("roughness = 0.5").specular, 1.0);
  EXPECT_EQ(material("roughness = 0.5, specular = 0.25").specular, 0.25);
  EXPECT_EQ(material("metallic = 1").specular, 1.0);
  EXPECT_FALSE(material("transmission = 1, thin = false").is_thin);
  EXPECT_TRUE(material("double_sided = true").is_double_sided);
}

TEST_F(TomlMaterialTest, AlphaChoosesAMode) {
  EXPECT_EQ(material("alpha = 0.5").alpha_mode, AlphaMode::blend);
  EXPECT_EQ(material("alpha = 0.5, alpha_mode = \"mask\"").alpha_mode, AlphaMode::mask);
  EXPECT_EQ(material("alpha = 0.5, alpha_mode = \"opaque\"").alpha_mode, AlphaMode::opaque);
  expect_error("alpha_mode = \"MASK\"", {"mesh.material.alpha_mode", "opaque, mask, blend"});
}

TEST_F(TomlMaterialTest, TexturesAreFilesOrTables) {
  write("t.png", test_support::png_bytes(1, 1, {1, 2, 3}));
  const Scene plain = load("reflectance_texture = \"t.png\", roughness_texture = \"t.png\"");
  const Material& of_plain = plain.materials.at(0);
  EXPECT_EQ(of_plain.reflectance, glm::dvec3(1.0));
  EXPECT_EQ(of_plain.roughness, 1.0);
  EXPECT_EQ(of_plain.specular, 1.0);
  ASSERT_EQ(plain.textures.size(), 2u);
  EXPECT_EQ(plain.textures.at(std::size_t(of_plain.textures.roughness.texture)).encoding,
            testbench::TexelEncoding::linear);
  const testbench::TextureReference reference =
      material(
          "metallic_texture = {file = \"t.png\", channel = \"b\", wrap_u = \"mirrored_repeat\", "
          "wrap_v = \"clamp_to_edge\", filter = \"nearest\", offset = [1, 2], rotation_degrees = 90, "
          "scale = [3, 4], coordinate_set = 1}")
          .textures.metallic;
  EXPECT_EQ(reference.channel, 2);
  EXPECT_EQ(reference.wrap_u, testbench::TextureWrap::mirrored_repeat);
  EXPECT_EQ(reference.wrap_v, testbench::TextureWrap::clamp_to_edge);
  EXPECT_EQ(reference.filter, testbench::TextureFilter::nearest);
  EXPECT_EQ(reference.transform.offset, glm::dvec2(1, 2));
  EXPECT_EQ(reference.transform.scale, glm::dvec2(3, 4));
  EXPECT_DOUBLE_EQ(reference.transform.rotation_radians, glm::half_pi<double>());
  EXPECT_EQ(reference.coordinate_set, 1);
}

TEST_F(TomlMaterialTest, AModeTakesTheAlphaOfTheReflectanceTexture) {
  test_support::PngContent content;
  content.colour_type = PNG_COLOR_TYPE_RGB_ALPHA;
  content.bytes = {1, 2, 3, 4};
  write("t.png", test_support::png_bytes(content));
  EXPECT_EQ(material("reflectance_texture = \"t.png\", alpha_mode = \"mask\"").textures.alpha.channel, 3);
  EXPECT_FALSE(material("reflectance_texture = \"t.png\"").textures.alpha);
}

TEST_F(TomlMaterialTest, RefusesWhatIsWrong) {
  write("t.png", "text");
  expect_error("colour = 1",
               {"scene.toml:7", "mesh.material.colour", "an unknown key", "reflectance, emission"});
  expect_error("thin = 1", {"mesh.material.thin", "true or false"});
  expect_error("reflectance_texture = \"no.png\"", {"scene.toml:7: reflectance_texture", "no.png"});
  expect_error("reflectance_texture = \"t.png\"", {"t.png: found an image in another format"});
  expect_error("reflectance_texture = \"/dev/zero\"", {"scene.toml:7", "outside the scene's folder"});
  expect_error("reflectance_texture = {}", {"reflectance_texture.file", "none"});
  expect_error("reflectance_texture = {file = \"t.png\", wrap = 1}", {"reflectance_texture.wrap", "unknown"});
  write("t.png", test_support::png_bytes(1, 1, {1, 2, 3}));
  const auto expect_texture_error = [&](const std::string& key, const std::vector<std::string>& parts) {
    expect_error("reflectance_texture = {file = \"t.png\", " + key + "}", parts);
  };
  expect_texture_error("wrap_u = \"wrap\"", {"wrap_u", "repeat, mirrored_repeat, clamp_to_edge"});
  expect_texture_error("coordinate_set = 2", {"coordinate_set", "0 to 1"});
  expect_texture_error("offset = [1]", {"offset", "[u, v]"});
  expect_texture_error("scale = [1, nan]", {"scale", "[u, v]"});
}

TEST_F(TomlMaterialTest, ReadsLights) {
  const Scene scene =
      load("",
           "[[light]]\ntype = \"point\"\nposition = [1, 2, 3]\nintensity = [4, 5, 6]\n"
           "[[light]]\ntype = \"spot\"\nposition = [0, 9, 0]\ndirection = [0, -3, 0]\n"
           "intensity = [1, 1, 1]\nouter_cone_degrees = 60\n"
           "[[light]]\ntype = \"directional\"\ndirection = [0, 0, 2]\nirradiance = [7, 7, 7]\n"
           "[[light]]\ntype = \"sun\"\ndirection = [0, -1, 0]\nirradiance = [3, 3, 3]\n");
  ASSERT_EQ(scene.lights.size(), 4u);
  EXPECT_EQ(scene.lights[0].kind, LightKind::point);
  EXPECT_EQ(scene.lights[0].position, glm::dvec3(1, 2, 3));
  EXPECT_EQ(scene.lights[0].intensity, glm::dvec3(4, 5, 6));
  EXPECT_EQ(scene.lights[1].direction, glm::dvec3(0, -1, 0));
  EXPECT_DOUBLE_EQ(scene.lights[1].outer_cone_radians, glm::pi<double>() / 3.0);
  EXPECT_EQ(scene.lights[1].inner_cone_radians, 0.0);
  EXPECT_EQ(scene.lights[2].kind, LightKind::directional);
  EXPECT_EQ(scene.lights[2].intensity, glm::dvec3(7));
  EXPECT_DOUBLE_EQ(scene.lights[3].angular_diameter_radians, glm::radians(0.53));
}

TEST_F(TomlMaterialTest, ReadsEnvironments) {
  EXPECT_FALSE(load("").environment.is_lit());
  const Scene constant = load("", "[environment]\nconstant = [1, 2, 3]\n");
  EXPECT_EQ(testbench::environment_radiance(constant.environment, {0, 1, 0}), glm::dvec3(1, 2, 3));
  write("sky.hdr", std::string("#?RADIANCE\n\n-Y 1 +X 4\n") +
                       "\x10\x10\x10\x80\x20\x20\x20\x80\x30\x30\x30\x80\x40\x40\x40\x80");
  const auto red = [](const Scene& scene, const glm::dvec3& direction) {
    return testbench::environment_radiance(scene.environment, direction).x * 256.0;
  };
  // From left to right: behind the left shoulder of a viewer who looks along -z, left ahead, right ahead, ...
  const Scene image = load("", "[environment]\nfile = \"sky.hdr\"\nscale = 2\n");
  EXPECT_EQ(red(image, {-0.8, 0, 0.6}), 2 * 16.5);
  EXPECT_EQ(red(image, {-0.8, 0, -0.6}), 2 * 32.5);
  EXPECT_EQ(red(image, {0.8, 0, -0.6}), 2 * 48.5);
  EXPECT_EQ(red(image, {0.8, 0, 0.6}), 2 * 64.5);
  // A quarter turn about y, counter-clockwise from above, brings -z to -x.
  const Scene turned = load("", "[environment]\nfile = \"sky.hdr\"\nrotation_degrees = 90\n");
  EXPECT_EQ(red(turned, {-0.8, 0, -0.6}), 48.5);
  EXPECT_EQ(red(turned, {-0.8, 0, 0.6}), 32.5);
  const Scene same = load("", "[environment]\nfile = \"sky.hdr\"\nrotation_degrees = [0, 90, 0]\n");
  EXPECT_EQ(same.environment.rotation, turned.environment.rotation);
  // No output takes the place of the sky.
  EXPECT_EQ(std::count(image.files.begin(), image.files.end(), directory_ / "sky.hdr"), 1);
}

/// The notes of a scene, a line each.
std::string notes_of(const Scene& scene) {
  std::string notes;
  for (const std::string& line : scene.notes.lines()) notes += line + "\n";
  return notes;
}

TEST_F(TomlMaterialTest, WhatPicturesDoNotShowIsNoted) {
  write("m.mtl", "");
  const std::string notes =
      notes_of(load("specular = 1.0, specular_colour = [1, 0.5, 0.5], transmission = 0.5, "
                    "transmission_colour = [1, 0, 0]",
                    "[environment]\nconstant = [1, 2, 3]\n[[light]]\ntype = \"point\"\n"
                    "position = [1, 2, 3]\nintensity = [4, 5, 6]\n"));
  EXPECT_NE(notes.find("scene.toml: a colour or strength of reflection is left out where light passes"),
            std::string::npos)
      << notes;
  EXPECT_EQ(notes.find("environment"), std::string::npos) << notes;
  EXPECT_EQ(notes.find("light without"), std::string::npos) << notes;
}

TEST_F(TomlMaterialTest, WhatPicturesShowIsNotNoted) {
  write("m.mtl", "");
  const std::string notes = notes_of(
      load("roughness = 0.5, alpha = 0.5, clearcoat = 1, sheen_colour = [1, 1, 1], transmission = 0.5, "
           "transmission_colour = [1, 0, 0]",
           "[environment]\nconstant = [1, 2, 3]\n"));
  EXPECT_EQ(notes.find("left out"), std::string::npos) << notes;
}

TEST_F(TomlMaterialTest, RefusesLightsThatAreNone) {
  const std::string point = "[[light]]\ntype = \"point\"\n";
  expect_table_error("[[light]]\n", {"light.type", "none"});
  expect_table_error("[[light]]\ntype = \"area\"\n", {"light.type", "point, spot, directional, sun"});
  expect_table_error("[light]\ntype = \"point\"\n", {"light", "[[light]]"});
  expect_table_error(point + "position = [0, 0, 0]\n", {"light.intensity", "none"});
  expect_table_error(point + "position = [0, 0, 0]\nintensity = [1, 1, -1]\n",
                     {"light.intensity", "0 to 1e30"});
  expect_table_error(point + "direction = [0, 0, 1]\n", {"light.direction", "unknown"});
  expect_table_error("[[light]]\ntype = \"sun\"\ndirection = [0, 0, 0]\nirradiance = [1, 1, 1]\n",
                     {"light.direction", "zero"});
  expect_table_error(
      "[[light]]\ntype = \"sun\"\ndirection = [0, 0, 1]\nirradiance = [1, 1, 1]\n"
      "angular_diameter_degrees = 180\n",
      {"angular_diameter_degrees", "less than 180"});
  expect_table_error("[[light]]\ntype = \"spot\"\ninner_cone_degrees = 45\n",
                     {"inner_cone_degrees", "smaller"});
}

TEST_F(TomlMaterialTest, RefusesEnvironmentsThatAreNone) {
  write("text.exr", "text");
  expect_table_error("[environment]\n", {"environment", "either file or constant"});
  expect_table_error("[environment]\nconstant = [1, 1, 1]\nfile = \"text.exr\"\n", {"environment", "either"});
  expect_table_error("[environment]\nconstant = [1, 1, 1]\nscale = 2\n",
                     {"environment.scale", "beside file"});
  expect_table_error("[environment]\nconstant = [1, 1]\n", {"environment.constant"});
  expect_table_error("[environment]\nfile = \"no.exr\"\n", {"environment.file", "no.exr"});
  expect_table_error("[environment]\nfile = \"/dev/zero\"\n", {"environment.file", "outside"});
  expect_table_error("environment = 3\n", {"mesh.environment"});
  test_support::expect_input_error([&] { load("", "[environment]\nfile = \"text.exr\"\n"); },
                                   {"text.exr: found a file in another format"});
}

TEST_F(TomlMaterialTest, SavingSaysWhatItLeavesOut) {
  write("t.png", test_support::png_bytes(1, 1, {1, 2, 3}));
  const Scene scene = load("reflectance_texture = \"t.png\"", "[environment]\nconstant = [1, 2, 3]\n");
  const std::string saved = (directory_ / "saved").string();
  EXPECT_EQ(testbench::save_scene(scene, saved).lines(),
            (std::vector<std::string>{
                saved + ": a material is saved without what it has besides reflectance and emission",
                saved + ": a texture is not saved", saved + ": normals and texture coordinates are not saved",
                saved + ": the environment is not saved"}));
  EXPECT_EQ(testbench::load_scene(saved).materials.at(0).reflectance, glm::dvec3(1.0));
  EXPECT_TRUE(testbench::save_scene(load(""), directory_ / "plain").lines().empty());
}

TEST(EnvironmentPlace, ComesBackFromItsDirection) {
  for (const glm::dvec2 place : {glm::dvec2(0.1, 0.2), glm::dvec2(0.5, 0.5), glm::dvec2(0.9, 0.99)}) {
    const glm::dvec2 found = testbench::environment_place(testbench::environment_direction(place));
    EXPECT_NEAR(found.x, place.x, 1e-15);
    EXPECT_NEAR(found.y, place.y, 1e-15);
  }
  EXPECT_EQ(testbench::environment_place({0, 0, -1}), glm::dvec2(0.5, 0.5));
  EXPECT_EQ(testbench::environment_place({0, 1, 0}).y, 0.0);
  EXPECT_EQ(testbench::environment_place({1, 0, 0}).x, 0.75);
}

/// The share falls by the square between the cones, as in the extension's formula.
TEST(SpotShare, FallsBetweenTheCones) {
  testbench::Light spot;
  spot.inner_cone_radians = std::acos(0.8);
  spot.outer_cone_radians = std::acos(0.4);
  EXPECT_EQ(testbench::spot_share(spot, 1.0), 1.0);
  EXPECT_EQ(testbench::spot_share(spot, 0.81), 1.0);
  EXPECT_NEAR(testbench::spot_share(spot, 0.6), 0.25, 1e-15);
  EXPECT_EQ(testbench::spot_share(spot, 0.39), 0.0);
}

/// The page has a row for each key, with its range.
TEST(MaterialKeys, AreInTheirPage) {
  const std::string page = test_support::read_file(CSX600_SOURCE_DIR "/docs/how-to/materials.md");
  for (const testbench::MaterialKey& key : testbench::material_keys()) {
    const std::string row =
        "| `" + std::string(key.name) + "` | " + testbench::allowed_by(key) + " | " + key.meaning + " |";
    EXPECT_NE(page.find(row), std::string::npos) << row;
  }
}

}  // namespace toml_material_test
