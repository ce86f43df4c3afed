// What MTL says of surfaces besides Kd and Ke, and their textures.

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>

#include "testbench/material/mtl_surface.hpp"
#include "testbench/scene/obj_mesh.hpp"
#include "testbench/scene_file/scene_file.hpp"
#include "testbench/texture/sample.hpp"
#include "tests/support/image_bytes.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/temporary_directory.hpp"

namespace mtl_material_test {

using testbench::AlphaMode;
using testbench::Material;
using testbench::Scene;
using testbench::TextureReference;
using testbench::TextureWrap;

class MtlMaterialTest : public test_support::DirectoryFixture {
 protected:
  /// The scene of a mesh whose material `m` has these lines besides that it emits, opened by itself.
  Scene open_mesh(const std::string& lines) {
    write_mesh(lines);
    return testbench::load_scene(directory_ / "m.obj");
  }
  /// The same as part of a scene.toml.
  Scene open_scene(const std::string& lines) {
    write_mesh(lines);
    return testbench::load_scene(
        write("scene.toml",
              "[camera]\nposition = [0, 0, 9]\nlook_at = [0, 0, 0]\nvertical_fov_degrees = 40\n"
              "[[mesh]]\nfile = \"m.obj\"\n"));
  }
  Material material(const std::string& lines) { return open_mesh(lines).materials.at(0); }
  void expect_error(const std::string& lines, const std::vector<std::string>& parts) {
    test_support::expect_input_error([&] { open_mesh(lines); }, parts);
  }
  std::string notes(const std::string& lines) {
    std::string text;
    for (const std::string& line : open_mesh(lines).notes.lines()) text += line + "\n";
    return text;
  }
  void write_image(const std::string& name, const std::vector<std::uint8_t>& rgb) {
    write(name, test_support::png_bytes(1, 1, rgb));
  }

 private:
  void write_mesh(const std::string& lines) {
    write("m.mtl", "newmtl m\nKd 0.5 0.5 0.5\nKe 1 1 1\n" + lines);
    write("m.obj",
          "mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n");
  }
};

TEST_F(MtlMaterialTest, WithoutGlossIsLambertian) {
  for (const char* lines : {"", "Ks 0 0 0\nNs 300\nillum 2\n", "Ks 1 1 1\nillum 1\n", "Ks 1 1 1\nillum 0\n",
                            "Ni 1.45\nd 1\nTr 0\nTf 0.5 1 1\n", "map_Ka a.png\n"})
    EXPECT_TRUE(testbench::is_plain(material(lines))) << lines;
}

/// Exponent 0 is as wide as GGX gets; 2 / (n + 2) is alpha squared, alpha roughness squared.
TEST_F(MtlMaterialTest, PhongBecomesGgx) {
  EXPECT_EQ(testbench::roughness_of_phong(0.0), 1.0);
  EXPECT_DOUBLE_EQ(testbench::roughness_of_phong(30.0), 0.5);
  EXPECT_DOUBLE_EQ(testbench::roughness_of_phong(510.0), 0.25);
  const Material glossy = material("Ks 0.02 0.04 1\nNs 30\n");
  EXPECT_DOUBLE_EQ(glossy.roughness, 0.5);
  EXPECT_EQ(glossy.specular, 1.0);
  for (int channel = 0; channel < 3; ++channel)
    EXPECT_DOUBLE_EQ(glossy.specular_colour[channel] * 0.04, (glm::dvec3(0.02, 0.04, 1))[channel]);
  EXPECT_EQ(glossy.reflectance, glm::dvec3(0.5));
  EXPECT_EQ(glossy.metallic, 0.0);
}

TEST_F(MtlMaterialTest, PhysicalKeywordsGoBeforePhong) {
  const Material metal = material("Ks 1 0 0\nNs 30\nPr 0.3\nPm 0.75\nPs 0.5\nPc 0.25\nPcr 0.125\n");
  EXPECT_EQ(metal.roughness, 0.3);
  EXPECT_EQ(metal.metallic, 0.75);
  EXPECT_EQ(metal.specular_colour, glm::dvec3(1.0));
  EXPECT_EQ(metal.sheen_colour, glm::dvec3(0.5));
  EXPECT_EQ(metal.sheen_roughness, 0.3);
  EXPECT_EQ(metal.clearcoat, 0.25);
  EXPECT_EQ(metal.clearcoat_roughness, 0.125);
  EXPECT_DOUBLE_EQ(material("Pm 1\nNs 30\n").roughness, 0.5);
}

TEST_F(MtlMaterialTest, DissolveIsAlphaUnlessLightRefracts) {
  const Material sheet = material("d 0.25\n");
  EXPECT_EQ(sheet.alpha_mode, AlphaMode::blend);
  EXPECT_EQ(sheet.alpha, 0.25);
  EXPECT_EQ(sheet.transmission, 0.0);
  EXPECT_EQ(material("Tr 0.25\n").alpha, 0.75);
  EXPECT_EQ(material("Tr 0.25\nd 0.5\n").alpha, 0.5);
  for (const char* model : {"6", "7"}) {
    const Material glass = material("illum " + std::string(model) + "\nNi 1.33\nTf 0.5 0.75 1\n");
    EXPECT_EQ(glass.transmission, 1.0);
    EXPECT_EQ(glass.transmission_colour, glm::dvec3(0.5, 0.75, 1));
    EXPECT_EQ(glass.ior, 1.33);
    EXPECT_EQ(glass.roughness, 0.0);
    EXPECT_FALSE(glass.is_thin);
    EXPECT_EQ(glass.alpha_mode, AlphaMode::opaque);
  }
  EXPECT_EQ(material("illum 7\nd 0.25\nPr 0.5\n").transmission, 0.75);
  EXPECT_EQ(material("illum 7\nd 0.25\nPr 0.5\n").roughness, 0.5);
}

TEST_F(MtlMaterialTest, NumbersOutOfRangeAreNotedAndLeftOut) {
  EXPECT_EQ(material("Ns -3\nKs 1 1 1\n").roughness, 1.0);
  EXPECT_EQ(material("Ni 0.5\nillum 7\n").ior, 1.5);
  EXPECT_EQ(material("Ks 2 1 1\n").specular, 0.0);
  EXPECT_NE(
      notes("Ns x\nPr 2\n").find("m.mtl:4: Ns: a number of MTL that is out of range is left out, 2 times"),
      std::string::npos);
  EXPECT_NE(notes("Tf 1 1\n").find("m.mtl:4: Tf: a colour of MTL that is out of range is left out"),
            std::string::npos);
}

TEST_F(MtlMaterialTest, TexturesHaveSlotsEncodingsAndAreReadOnce) {
  write_image("a b.png", {255, 0, 0});
  write_image("grey.png", {9, 8, 9});
  const Scene scene = open_mesh(
      "map_Kd a b.png # comment\nmap_Ke a b.png\nmap_Pr grey.png\nmap_Pm -imfchan b grey.png\n"
      "norm -bm 0.5 grey.png\n");
  ASSERT_EQ(scene.textures.size(), 2u);
  const testbench::MaterialTextures& textures = scene.materials.at(0).textures;
  EXPECT_EQ(scene.textures.at(std::size_t(textures.reflectance.texture)).encoding,
            testbench::TexelEncoding::srgb);
  EXPECT_EQ(textures.emission.texture, textures.reflectance.texture);
  EXPECT_EQ(scene.textures.at(std::size_t(textures.roughness.texture)).encoding,
            testbench::TexelEncoding::linear);
  EXPECT_EQ(textures.metallic.texture, textures.roughness.texture);
  EXPECT_EQ(textures.roughness.channel, 0);
  EXPECT_EQ(textures.metallic.channel, 2);
  EXPECT_EQ(textures.normal.texture, textures.roughness.texture);
  EXPECT_EQ(scene.materials[0].normal_scale, 0.5);
  EXPECT_FALSE(textures.alpha);
  EXPECT_EQ(scene.corners.coordinates[0].at(0)[2], glm::dvec2(0, 0));  // vt 0 1 is the upper left
}

TEST_F(MtlMaterialTest, TexturesOfPhysicalKeywordsMultiplyOne) {
  write_image("t.png", {1, 2, 3});
  const Material metal = material("Ks 1 0 0\nNs 30\nmap_Pm t.png\nmap_Pr t.png\n");
  EXPECT_EQ(metal.metallic, 1.0);
  EXPECT_EQ(metal.roughness, 1.0);
  EXPECT_EQ(metal.specular_colour, glm::dvec3(1.0));
  EXPECT_EQ(material("Pm 0.5\nmap_Pm t.png\nPr 0.25\nmap_Pr t.png\n").metallic, 0.5);
  EXPECT_EQ(material("map_Pr t.png\nPr 0.25\n").roughness, 0.25);
  EXPECT_EQ(material("map_Pm no.png\n").metallic, 0.0);
  EXPECT_FALSE(material("map_Pr t.png\nPr 0\n").textures.roughness);  // shows nothing
}

TEST_F(MtlMaterialTest, OpacityMapsTakeAlphaIfThereIsOne) {
  write_image("rgb.png", {1, 2, 3});
  test_support::PngContent content;
  content.colour_type = PNG_COLOR_TYPE_RGB_ALPHA;
  content.bytes = {1, 2, 3, 4};
  write("rgba.png", test_support::png_bytes(content));
  EXPECT_EQ(material("map_d rgb.png\n").textures.alpha.channel, 0);
  EXPECT_EQ(material("map_d rgba.png\n").textures.alpha.channel, 3);
  EXPECT_EQ(material("map_d rgba.png\n").alpha_mode, AlphaMode::blend);
}

/// MTL scales and moves vt, whose v grows upwards.
TEST_F(MtlMaterialTest, OptionsMoveScaleAndClamp) {
  write_image("-a.png", {1, 2, 3});
  const TextureReference reference =
      material("map_Kd -blendu on -s 2 4 1 -o 0.5 0.25 -mm 0 1 -clamp on -texres 8 -a.png\n")
          .textures.reflectance;
  ASSERT_TRUE(reference);
  EXPECT_EQ(reference.wrap_u, TextureWrap::clamp_to_edge);
  EXPECT_EQ(reference.wrap_v, TextureWrap::clamp_to_edge);
  const glm::dvec2 vt(0.125, 0.375);
  const glm::dvec2 place = testbench::transformed(reference.transform, {vt.x, 1.0 - vt.y});
  EXPECT_DOUBLE_EQ(place.x, 2.0 * vt.x + 0.5);
  EXPECT_DOUBLE_EQ(1.0 - place.y, 4.0 * vt.y + 0.25);
  EXPECT_EQ(material("map_Kd -a.png\n").textures.reflectance.wrap_u, TextureWrap::repeat);
}

TEST_F(MtlMaterialTest, BumpIsANormalMapUnlessItIsGrey) {
  write_image("normal.png", {128, 128, 255});
  write_image("height.png", {50, 50, 50});
  EXPECT_TRUE(material("map_Bump -bm 2 normal.png\n").textures.normal);
  EXPECT_EQ(material("bump -bm 2 normal.png\n").normal_scale, 2.0);
  const Scene height = open_mesh("bump height.png\n");
  EXPECT_FALSE(height.materials.at(0).textures.normal);
  EXPECT_TRUE(height.textures.empty());
  EXPECT_TRUE(height.corners.is_empty());
  EXPECT_NE(notes("bump height.png\n")
                .find("m.mtl:4: bump: height.png: a height map (bump) of one height shows nothing"),
            std::string::npos);
}

/// 51 texels for white, 5 codes a texel: a slope of one in the middle of three columns.
TEST_F(MtlMaterialTest, GreyBumpIsHeightsOfWhichNormalsAreMade) {
  write("ramp.png", test_support::png_bytes(3, 1, {10, 10, 10, 15, 15, 15, 20, 20, 20}));
  const Scene scene = open_mesh("map_bump -clamp on -bm 51 ramp.png\n");
  const Material& bumpy = scene.materials.at(0);
  ASSERT_TRUE(bumpy.textures.normal);
  EXPECT_EQ(bumpy.normal_scale, 1.0);
  EXPECT_EQ(bumpy.textures.normal.wrap_u, TextureWrap::clamp_to_edge);
  ASSERT_EQ(scene.textures.size(), 1u);
  const testbench::Image& normals = scene.textures[0].image;
  ASSERT_EQ(normals.texels.size(), 9u);
  EXPECT_EQ(std::vector<int>(normals.texels.begin() + 3, normals.texels.begin() + 6),
            (std::vector<int>{37, 128, 218}));  // 127.5 * (1 -+ sqrt(1/2))
  EXPECT_EQ(scene.textures[0].encoding, testbench::TexelEncoding::linear);
  for (const char* no_number : {"inf", "nan", "abc"})
    EXPECT_EQ(material("norm -bm " + std::string(no_number) + " ramp.png\n").normal_scale, 1.0);
  EXPECT_EQ(notes("map_bump ramp.png\n").find("height map"), std::string::npos);
  EXPECT_EQ(open_mesh("norm ramp.png\n").textures.at(0).image.texels[0], 10);  // normals by its keyword
}

TEST_F(MtlMaterialTest, AMissingTextureIsAnErrorInASceneAndANoteForAMeshAlone) {
  EXPECT_NE(notes("map_Kd no.png\n").find("m.mtl:4: map_Kd: no.png: a texture is missing"),
            std::string::npos);
  test_support::expect_input_error(
      [&] { open_scene("map_Kd no.png\n"); },
      {"m.mtl:4: map_Kd: found no file 'no.png'", "allowed: a PNG or JPEG file"});
}

TEST_F(MtlMaterialTest, RefusesTexturesThatAreNone) {
  write("empty.png", "");
  write("text.png", "no image");
  test_support::PngContent content;
  content.bit_depth = 16;
  content.bytes = std::vector<std::uint8_t>(6, 1);
  write("deep.png", test_support::png_bytes(content));
  write("cut.png", test_support::png_bytes(1, 1, {1, 2, 3}).substr(0, 50));
  ASSERT_EQ(mkfifo((directory_ / "pipe.png").c_str(), 0600), 0);
  expect_error("map_Kd empty.png\n", {"empty.png: found an empty image"});
  expect_error("map_Kd text.png\n", {"text.png: found an image in another format", "PNG or JPEG"});
  expect_error("map_Kd deep.png\n", {"deep.png: found a PNG file of 16 bits"});
  expect_error("map_Kd cut.png\n", {"cut.png: found a PNG file that cannot be read"});
  expect_error("map_Kd pipe.png\n", {"m.mtl:4: map_Kd", "pipe.png", "a regular file"});
  expect_error("map_Kd /dev/zero\n", {"m.mtl:4: map_Kd", "outside the scene's folder"});
}

}  // namespace mtl_material_test
