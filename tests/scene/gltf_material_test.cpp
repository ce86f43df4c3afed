// Materials, textures and lights of glTF files.

#include "testbench/material/gltf_material.hpp"

#include <gtest/gtest.h>
#include <openssl/evp.h>

#include <cmath>

#include "testbench/scene/gltf_mesh.hpp"
#include "testbench/texture/texture_store.hpp"
#include "tests/support/gltf_builder.hpp"
#include "tests/support/image_bytes.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/temporary_directory.hpp"

namespace gltf_material_test {

using nlohmann::json;
using test_support::GltfBuilder;
using testbench::AlphaMode;
using testbench::LightKind;
using testbench::Material;
using testbench::Mesh;
using testbench::TextureReference;
using testbench::TextureWrap;

std::string base64_of(const std::string& bytes) {
  std::string text((bytes.size() + 2) / 3 * 4 + 1, '\0');
  text.resize(std::size_t(EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()),
                                          reinterpret_cast<const unsigned char*>(bytes.data()),
                                          static_cast<int>(bytes.size()))));
  return text;
}

/// A file of one triangle with this material and two sets of texture coordinates.
GltfBuilder file_of(const json& material) {
  GltfBuilder file;
  const std::size_t positions = file.add_accessor("VEC3", 3, test_support::kGltfCorners);
  const std::size_t first = file.add_accessor<float>("VEC2", 2, std::vector<float>{0, 0, 1, 0, 0, 1});
  const std::size_t second =
      file.add_accessor<std::uint8_t>("VEC2", 2, std::vector<std::uint8_t>{255, 0, 0, 51, 0, 0}, true);
  file.add_mesh({{"POSITION", positions}, {"TEXCOORD_0", first}, {"TEXCOORD_1", second}}, {{"material", 0}});
  file.add("materials", material);
  file.add_node({{"mesh", 0}});
  return file;
}

class GltfMaterialTest : public test_support::DirectoryFixture {
 protected:
  Mesh load(const GltfBuilder& file) {
    write("a.bin", file.bytes);
    const auto path = write("a.gltf", file.root.dump());
    const testbench::MeshOptions options{testbench::FileReach(directory_), std::nullopt};
    textures_ = options.textures;
    return testbench::load_gltf(path, options).mesh;
  }
  Material material(const json& source) { return load(file_of(source)).materials.at(0); }
  Material extended(const char* name, const json& content) {
    return material({{"extensions", {{name, content}}}});
  }
  void expect_error(const GltfBuilder& file, const std::vector<std::string>& parts) {
    test_support::expect_input_error([&] { load(file); }, parts);
  }

  std::shared_ptr<testbench::TextureStore> textures_;
};

TEST_F(GltfMaterialTest, ReadsMetallicRoughness) {
  const Material given = material(
      {{"pbrMetallicRoughness",
        {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}}, {"metallicFactor", 0.5}, {"roughnessFactor", 0.25}}},
       {"doubleSided", true}});
  EXPECT_EQ(given.reflectance, glm::dvec3(0.1, 0.2, 0.3));
  EXPECT_EQ(given.metallic, 0.5);
  EXPECT_EQ(given.roughness, 0.25);
  EXPECT_EQ(given.specular, 1.0);
  EXPECT_EQ(given.alpha, 1.0);  // OPAQUE ignores it
  EXPECT_TRUE(given.is_double_sided);
  const Material standard = material(json::object());
  EXPECT_EQ(standard.metallic, 1.0);
  EXPECT_EQ(standard.roughness, 1.0);
}

TEST_F(GltfMaterialTest, ReadsAlpha) {
  const json colour{{"baseColorFactor", {1, 1, 1, 0.5}}};
  const Material blend = material({{"alphaMode", "BLEND"}, {"pbrMetallicRoughness", colour}});
  EXPECT_EQ(blend.alpha_mode, AlphaMode::blend);
  EXPECT_EQ(blend.alpha, 0.5);
  const Material mask =
      material({{"alphaMode", "MASK"}, {"alphaCutoff", 0.25}, {"pbrMetallicRoughness", colour}});
  EXPECT_EQ(mask.alpha_mode, AlphaMode::opaque);  // cut out or whole, as MaskCutsOutByAlpha shows
  EXPECT_EQ(mask.alpha, 1.0);
}

TEST_F(GltfMaterialTest, AMaskOfATextureStays) {
  test_support::PngContent content;
  content.colour_type = PNG_COLOR_TYPE_RGB_ALPHA;
  content.bytes = {1, 2, 3, 4};
  write("t.png", test_support::png_bytes(content));
  GltfBuilder file = file_of({{"alphaMode", "MASK"},
                              {"alphaCutoff", 0.25},
                              {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  file.add("textures", {{"source", 0}});
  file.add("images", {{"uri", "t.png"}});
  const Material mask = load(file).materials.at(0);
  EXPECT_EQ(mask.alpha_mode, AlphaMode::mask);
  EXPECT_EQ(mask.alpha_cutoff, 0.25);
  EXPECT_EQ(mask.textures.alpha.channel, 3);
}

TEST_F(GltfMaterialTest, ReadsExtensions) {
  const Material coat =
      extended("KHR_materials_clearcoat", {{"clearcoatFactor", 0.5}, {"clearcoatRoughnessFactor", 0.25}});
  EXPECT_EQ(coat.clearcoat, 0.5);
  EXPECT_EQ(coat.clearcoat_roughness, 0.25);
  const Material sheen =
      extended("KHR_materials_sheen", {{"sheenColorFactor", {0.1, 0.2, 0.3}}, {"sheenRoughnessFactor", 0.5}});
  EXPECT_EQ(sheen.sheen_colour, glm::dvec3(0.1, 0.2, 0.3));
  EXPECT_EQ(sheen.sheen_roughness, 0.5);
  const Material specular =
      extended("KHR_materials_specular", {{"specularFactor", 0.5}, {"specularColorFactor", {2, 1, 0}}});
  EXPECT_EQ(specular.specular, 0.5);
  EXPECT_EQ(specular.specular_colour, glm::dvec3(2, 1, 0));
  EXPECT_EQ(extended("KHR_materials_ior", {{"ior", 1.33}}).ior, 1.33);
  EXPECT_EQ(extended("KHR_materials_ior", {{"ior", 0}}).specular_colour, glm::dvec3(1.0 / 0.04));
  EXPECT_EQ(extended("KHR_materials_transmission", {{"transmissionFactor", 0.75}}).transmission, 0.75);
  const Material thin = extended("KHR_materials_volume", {{"attenuationDistance", 3}});
  EXPECT_TRUE(thin.is_thin);
  const Material thick =
      extended("KHR_materials_volume",
               {{"thicknessFactor", 0.1}, {"attenuationDistance", 3}, {"attenuationColor", {0.1, 0.2, 0.3}}});
  EXPECT_FALSE(thick.is_thin);
  EXPECT_EQ(thick.attenuation_distance, 3.0);
  EXPECT_EQ(thick.attenuation_colour, glm::dvec3(0.1, 0.2, 0.3));
}

TEST_F(GltfMaterialTest, GlossinessIsTheRestOfRoughness) {
  const Material glossy =
      extended("KHR_materials_pbrSpecularGlossiness", {{"diffuseFactor", {0.5, 0.25, 0.125, 1}},
                                                       {"specularFactor", {0.04, 0.5, 1}},
                                                       {"glossinessFactor", 0.75}});
  EXPECT_EQ(glossy.reflectance, glm::dvec3(0.5, 0.25, 0.125));
  EXPECT_EQ(glossy.metallic, 0.0);
  EXPECT_EQ(glossy.roughness, 0.25);
  EXPECT_DOUBLE_EQ(glossy.specular_colour.x, 1.0);
  EXPECT_DOUBLE_EQ(glossy.specular_colour.z, 25.0);
}

TEST_F(GltfMaterialTest, ExtensionsAreChecked) {
  const auto expect_extension_error = [&](const char* name, const json& content,
                                          const std::vector<std::string>& parts) {
    expect_error(file_of({{"extensions", {{name, content}}}}), parts);
  };
  expect_extension_error("KHR_materials_ior", {{"ior", 0.5}}, {"/materials/0", "ior", "found 0.5", "from 1"});
  expect_extension_error("KHR_materials_clearcoat", {{"clearcoatFactor", 2}}, {"clearcoatFactor", "0 to 1"});
  expect_extension_error("KHR_materials_volume", {{"attenuationDistance", 0}},
                         {"attenuationDistance", "above 0"});
  expect_extension_error("KHR_materials_sheen", {{"sheenColorFactor", {1, 1}}},
                         {"sheenColorFactor", "array of 3"});
}

/// The same with a texture of t.png as its base colour.
GltfBuilder textured_file(const json& info = {{"index", 0}}) {
  GltfBuilder file = file_of({{"pbrMetallicRoughness", {{"baseColorTexture", info}}}});
  file.add("textures", {{"source", 0}});
  file.add("images", {{"uri", "t.png"}});
  return file;
}

TEST_F(GltfMaterialTest, ReadsImagesFromFilesDataAndBufferViews) {
  const std::string png = test_support::png_bytes(1, 1, {7, 8, 9});
  const std::string jpeg = test_support::jpeg_bytes(1, 1, {7}, JCS_GRAYSCALE);
  write("t u.png", png);
  GltfBuilder file = textured_file();
  const std::size_t view = file.add_bytes(jpeg);
  const std::vector<std::pair<json, std::uint8_t>> images{
      {{{"uri", "t%20u.png"}}, 8},
      {{{"uri", "data:image/png;base64," + base64_of(png)}}, 8},
      {{{"bufferView", view}, {"mimeType", "image/jpeg"}}, 7}};
  for (const auto& [image, green] : images) {
    file.root["images"][0] = image;
    const Mesh mesh = load(file);
    const TextureReference& reference = mesh.materials.at(0).textures.reflectance;
    ASSERT_TRUE(reference);
    const testbench::Texture& texture = textures_->at(reference.texture);
    EXPECT_EQ(texture.image.texels.at(texture.image.texels.size() / 2), green);
    EXPECT_EQ(texture.encoding, testbench::TexelEncoding::srgb);
    EXPECT_EQ(mesh.corners.coordinates[0].at(0)[1], glm::dvec2(1, 0));
    EXPECT_EQ(mesh.corners.coordinates[1].at(0)[1], glm::dvec2(0, 0.2));
  }
}

TEST_F(GltfMaterialTest, RefusesImagesThatAreNone) {
  write("t.png", "text");
  const auto expect_image_error = [&](const json& image, const std::vector<std::string>& parts) {
    GltfBuilder file = textured_file();
    file.root["images"][0] = image;
    expect_error(file, parts);
  };
  expect_image_error({{"uri", "t.png"}}, {"t.png: found an image in another format"});
  expect_image_error({{"uri", "no.png"}}, {"a.gltf: /images/0/uri", "no file", "no.png"});
  expect_image_error({{"uri", "../../no.png"}}, {"/images/0/uri"});
  expect_image_error({{"uri", "data:image/png;base64,####"}}, {"/images/0/uri", "base64"});
  expect_image_error({{"uri", "data:image/png;base64,AAAA"}},
                     {"a.gltf: /images/0: found an image in another"});
  expect_image_error({{"uri", "t.png"}, {"mimeType", "image/webp"}}, {"/images/0/mimeType", "image/png"});
  expect_image_error({{"uri", "t.png"}, {"bufferView", 0}}, {"/images/0", "one of them"});
  expect_image_error(json::object(), {"/images/0", "one of them"});
  expect_image_error({{"bufferView", 99}}, {"/images/0/bufferView", "bufferView 99"});
}

TEST_F(GltfMaterialTest, ReadsSamplersAndTransforms) {
  write("t.png", test_support::png_bytes(1, 1, {7, 8, 9}));
  GltfBuilder file =
      textured_file({{"index", 0},
                     {"texCoord", 0},
                     {"extensions",
                      {{"KHR_texture_transform",
                        {{"offset", {0.5, 0.25}}, {"rotation", 1.5}, {"scale", {2, 3}}, {"texCoord", 1}}}}}});
  const auto reference = [&] { return load(file).materials.at(0).textures.reflectance; };
  EXPECT_EQ(reference().coordinate_set, 1);
  EXPECT_EQ(reference().transform.offset, glm::dvec2(0.5, 0.25));
  EXPECT_EQ(reference().transform.scale, glm::dvec2(2, 3));
  EXPECT_EQ(reference().transform.rotation_radians, 1.5);
  EXPECT_EQ(reference().wrap_u, TextureWrap::repeat);
  EXPECT_EQ(reference().filter, testbench::TextureFilter::linear);
  file.root["textures"][0]["sampler"] = 0;
  file.add("samplers", {{"wrapS", 33071}, {"wrapT", 33648}, {"minFilter", 9986}});
  EXPECT_EQ(reference().wrap_u, TextureWrap::clamp_to_edge);
  EXPECT_EQ(reference().wrap_v, TextureWrap::mirrored_repeat);
  EXPECT_EQ(reference().filter, testbench::TextureFilter::nearest);
  file.root["samplers"][0]["magFilter"] = 9729;
  EXPECT_EQ(reference().filter, testbench::TextureFilter::linear);
  file.root["samplers"][0]["wrapS"] = 1;
  expect_error(file, {"/samplers/0/wrapS", "33071"});
}

TEST_F(GltfMaterialTest, TexturesHaveTheirSlotsAndChannels) {
  write("t.png", test_support::png_bytes(1, 1, {7, 8, 9}));
  GltfBuilder file = textured_file();
  const json info{{"index", 0}};
  file.root["materials"][0] = {
      {"pbrMetallicRoughness", {{"baseColorTexture", info}, {"metallicRoughnessTexture", info}}},
      {"normalTexture", {{"index", 0}, {"scale", -0.5}}},
      {"emissiveTexture", info},
      {"emissiveFactor", {1, 1, 1}},
      {"alphaMode", "BLEND"},
      {"extensions", {{"KHR_materials_transmission", {{"transmissionTexture", info}}}}}};
  const Material with_all = load(file).materials.at(0);
  EXPECT_EQ(with_all.textures.roughness.channel, 1);
  EXPECT_EQ(with_all.textures.metallic.channel, 2);
  EXPECT_EQ(with_all.textures.transmission.channel, 0);
  EXPECT_EQ(with_all.textures.roughness.texture, with_all.textures.normal.texture);
  EXPECT_EQ(with_all.textures.emission.texture, with_all.textures.reflectance.texture);
  EXPECT_NE(with_all.textures.emission.texture, with_all.textures.normal.texture);
  EXPECT_EQ(with_all.normal_scale, -0.5);
  EXPECT_FALSE(with_all.textures.alpha);  // the image has none
  test_support::PngContent content;
  content.colour_type = PNG_COLOR_TYPE_RGB_ALPHA;
  content.bytes = {1, 2, 3, 4};
  write("t.png", test_support::png_bytes(content));
  EXPECT_EQ(load(file).materials.at(0).textures.alpha.channel, 3);
  file.root["materials"][0].erase("alphaMode");
  EXPECT_FALSE(load(file).materials.at(0).textures.alpha);
}

TEST_F(GltfMaterialTest, NotesTexturesThatItCannotRead) {
  const auto notes_of = [&](const GltfBuilder& file) {
    std::string text;
    const Mesh mesh = load(file);
    EXPECT_FALSE(mesh.materials.at(0).textures.reflectance);
    for (const std::string& line : mesh.notes.lines()) text += line + "\n";
    return text;
  };
  GltfBuilder file = textured_file();
  file.root["textures"][0] = {{"extensions", {{"KHR_texture_basisu", {{"source", 0}}}}}};
  EXPECT_NE(notes_of(file).find("a texture without a PNG or JPEG image is left out"), std::string::npos);
  EXPECT_NE(notes_of(textured_file({{"index", 0}, {"texCoord", 2}})).find("beyond TEXCOORD_1"),
            std::string::npos);
}

/// Colours of vertices change the base colour alone.
TEST_F(GltfMaterialTest, VertexColoursKeepTheRestOfTheMaterial) {
  GltfBuilder file = file_of({{"alphaMode", "BLEND"}, {"pbrMetallicRoughness", {{"roughnessFactor", 0.25}}}});
  std::vector<float> colours;
  for (int i = 0; i < 3; ++i) colours.insert(colours.end(), {0.5f, 0.25f, 1.0f, 0.75f});
  file.root["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] =
      file.add_accessor<float>("VEC4", 4, colours);
  const Material coloured = load(file).materials.at(0);
  EXPECT_EQ(coloured.reflectance, glm::dvec3(0.5, 0.25, 1));
  EXPECT_EQ(coloured.alpha, 0.75);
  EXPECT_EQ(coloured.roughness, 0.25);
}

TEST_F(GltfMaterialTest, ReadsPunctualLights) {
  GltfBuilder file = file_of(json::object());
  file.root["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "point"}, {"color", {1, 0.5, 0.25}}, {"intensity", 8}, {"range", 3}},
      {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.25}}}},
      {{"type", "directional"}, {"name", "noon"}}};
  const auto add_light = [&](int index, json node) {
    node["extensions"]["KHR_lights_punctual"]["light"] = index;
    file.add_node(node);
  };
  add_light(0, {{"translation", {1, 2, 3}}, {"scale", {5, 5, 5}}});
  add_light(1, {{"rotation", {0.7071067811865476, 0, 0, 0.7071067811865476}}});  // -z becomes +y
  add_light(2, json::object());
  const Mesh mesh = load(file);
  ASSERT_EQ(mesh.lights.size(), 3u);
  EXPECT_EQ(mesh.lights[0].kind, LightKind::point);
  EXPECT_EQ(mesh.lights[0].intensity, glm::dvec3(8, 4, 2));
  EXPECT_EQ(mesh.lights[0].position, glm::dvec3(1, 2, 3));
  EXPECT_EQ(mesh.lights[1].kind, LightKind::spot);
  EXPECT_NEAR(mesh.lights[1].direction.y, 1.0, 1e-15);
  EXPECT_EQ(mesh.lights[1].inner_cone_radians, 0.25);
  EXPECT_DOUBLE_EQ(mesh.lights[1].outer_cone_radians, std::atan(1.0));
  EXPECT_EQ(mesh.lights[2].kind, LightKind::directional);
  EXPECT_EQ(mesh.lights[2].direction, glm::dvec3(0, 0, -1));
  EXPECT_EQ(mesh.lights[2].name, "noon");
}

TEST_F(GltfMaterialTest, PunctualLightsAreChecked) {
  const auto expect_light_error = [&](const json& light, const std::vector<std::string>& parts) {
    GltfBuilder file = file_of(json::object());
    file.root["extensions"]["KHR_lights_punctual"]["lights"] = {light};
    file.root["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
    expect_error(file, parts);
  };
  expect_light_error({{"type", "area"}}, {"lights/0/type", "directional, point, spot"});
  expect_light_error({{"type", "point"}, {"intensity", -1}}, {"lights/0/intensity"});
  expect_light_error({{"type", "spot"}, {"spot", {{"outerConeAngle", 1.6}}}}, {"outerConeAngle", "1.5708"});
  expect_light_error({{"type", "spot"}, {"spot", {{"innerConeAngle", 1}, {"outerConeAngle", 1}}}},
                     {"/spot", "inner cone"});
  GltfBuilder file = file_of(json::object());
  file.root["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 1;
  expect_error(file, {"KHR_lights_punctual/light", "light 1", "none"});
}

}  // namespace gltf_material_test
