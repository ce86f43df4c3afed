#include "testbench/gltf/gltf_schema.hpp"

#include <gtest/gtest.h>

#include "testbench/scene/gltf_mesh.hpp"
#include "testbench/scene_file/scene_file.hpp"
#include "tests/support/gltf_builder.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/temporary_directory.hpp"

namespace gltf_schema_test {

using nlohmann::json;
using test_support::GltfBuilder;

/// A file that uses nearly all that has a rule, and loads.
GltfBuilder full_file() {
  GltfBuilder file;
  const std::size_t points = file.add_accessor("VEC3", 3, test_support::kGltfCorners);
  const std::size_t indices = file.add_accessor<std::uint16_t>("SCALAR", 1, {0, 1, 2});
  const std::size_t zeros = file.add("accessors", {{"componentType", 5126}, {"count", 3}, {"type", "VEC3"}});
  file.add("materials",
           {{"name", "lamp"},
            {"pbrMetallicRoughness",
             {{"baseColorFactor", {0.5, 0.5, 0.5, 1}}, {"metallicFactor", 0}, {"roughnessFactor", 1}}},
            {"emissiveFactor", {1, 1, 1}},
            {"alphaMode", "OPAQUE"},
            {"alphaCutoff", 0.5},
            {"doubleSided", false},
            {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 5}}}}}});
  file.add_mesh({{"POSITION", points}}, {{"indices", indices},
                                         {"material", 0},
                                         {"mode", 4},
                                         {"targets", json::array({{{"POSITION", zeros}}})}});
  file.add("cameras",
           {{"type", "perspective"}, {"perspective", {{"yfov", 0.8}, {"aspectRatio", 1.5}, {"znear", 0.1}}}});
  file.add_node({{"mesh", 0},
                 {"translation", {0, 0, 0}},
                 {"rotation", {0, 0, 0, 1}},
                 {"scale", {1, 1, 1}},
                 {"weights", {0.5}}});
  file.add_node({{"camera", 0}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 4, 1}}});
  file.root["scene"] = 0;
  return file;
}

class GltfSchema : public test_support::DirectoryFixture {
 protected:
  testbench::GltfFile load(const GltfBuilder& file) {
    write("a.bin", file.bytes);
    const auto path = write("a.gltf", file.root.dump());
    return testbench::load_gltf(path, {testbench::FileReach(path.parent_path()), std::nullopt});
  }
};

TEST_F(GltfSchema, TheWholeFileLoads) {
  const testbench::GltfFile file = load(full_file());
  EXPECT_EQ(file.mesh.triangles.size(), 1u);
  EXPECT_TRUE(file.camera);
  EXPECT_TRUE(file.mesh.notes.lines().empty());
}

/// A value of a wrong type or out of range is refused by its place, whatever a lenient reader would make of
/// it.
TEST_F(GltfSchema, RefusesWrongValuesByTheirPlace) {
  const std::vector<std::pair<const char*, json>> wrong{
      {"/nodes/0/mesh", -1},
      {"/nodes/0/mesh", "0"},
      {"/nodes/0/mesh", 0.7},
      {"/nodes/0/mesh", 1},
      {"/nodes/0/mesh", nullptr},
      {"/nodes/0/mesh", 4294967296},
      {"/nodes/0/mesh", true},
      {"/nodes/1/camera", 1},
      {"/nodes/0/skin", 0},
      {"/nodes/0/children", 1},
      {"/nodes/0/children", json::array()},
      {"/nodes/0/children", {9}},
      {"/nodes/0/translation", {1, 2}},
      {"/nodes/0/scale", {0.5, 0.5}},
      {"/nodes/0/scale", {1, 1, "1"}},
      {"/nodes/0/rotation", {0, 0, 0, 2}},
      {"/nodes/0/rotation", {0, 0, 0, 0}},
      {"/nodes/0/rotation", {0, 0, 1}},
      {"/nodes/1/matrix", json(std::vector<int>(15, 2))},
      {"/nodes/1/matrix", {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}},
      {"/nodes/0/weights", {nullptr}},
      {"/scene", 1},
      {"/scene", "0"},
      {"/scenes/0/nodes", 0},
      {"/scenes/0/nodes/1", -1},
      {"/meshes/0/primitives", json::array()},
      {"/meshes/0/primitives", json::object()},
      {"/meshes/0/primitives/0/mode", 7},
      {"/meshes/0/primitives/0/mode", -1},
      {"/meshes/0/primitives/0/mode", 4.5},
      {"/meshes/0/primitives/0/material", -1},
      {"/meshes/0/primitives/0/material", 1},
      {"/meshes/0/primitives/0/indices", "1"},
      {"/meshes/0/primitives/0/attributes", json::array({0})},
      {"/meshes/0/primitives/0/attributes/POSITION", -1},
      {"/meshes/0/primitives/0/attributes/POSITION", 0.5},
      {"/meshes/0/primitives/0/targets/0/POSITION", 77},
      {"/accessors/0/byteOffset", -1},
      {"/accessors/0/byteOffset", "0"},
      {"/accessors/0/bufferView", 0.5},
      {"/accessors/0/count", 0},
      {"/accessors/0/count", -3},
      {"/accessors/0/count", 2.5},
      {"/accessors/0/componentType", 5124},
      {"/accessors/0/componentType", "5126"},
      {"/accessors/0/type", "VEC5"},
      {"/accessors/0/type", "VEC3 VEC4"},
      {"/accessors/0/type", 3},
      {"/accessors/0/normalized", 1},
      {"/accessors/0/sparse", 0},
      {"/bufferViews/0/byteOffset", -4},
      {"/bufferViews/0/byteLength", 0},
      {"/bufferViews/0/byteStride", 3},
      {"/bufferViews/0/byteStride", 256},
      {"/bufferViews/0/buffer", 3},
      {"/bufferViews/0/target", 1},
      {"/buffers/0/byteLength", -1},
      {"/buffers/0/uri", 7},
      {"/materials/0/pbrMetallicRoughness", json::array({1})},
      {"/materials/0/pbrMetallicRoughness/baseColorFactor", {0.5}},
      {"/materials/0/pbrMetallicRoughness/baseColorFactor/2", -0.1},
      {"/materials/0/pbrMetallicRoughness/metallicFactor", 1.5},
      {"/materials/0/pbrMetallicRoughness/roughnessFactor", "rough"},
      {"/materials/0/emissiveFactor", {1, 1, 1, 1}},
      {"/materials/0/emissiveFactor/0", 3},
      {"/materials/0/extensions/KHR_materials_emissive_strength/emissiveStrength", json::object()},
      {"/materials/0/extensions/KHR_materials_emissive_strength/emissiveStrength", -1},
      {"/materials/0/alphaMode", "mask"},
      {"/materials/0/alphaCutoff", -1},
      {"/materials/0/doubleSided", "true"},
      {"/materials/0/name", 5},
      {"/cameras/0/type", "wide"},
      {"/cameras/0/perspective/yfov", 0},
      {"/cameras/0/perspective/yfov", 3.2},
      {"/cameras/0/perspective/znear", -1},
      {"/cameras/0/perspective/aspectRatio", 0},
      {"/asset/version", "1.0"},
      {"/asset/version", "3.0"},
      {"/asset/version", 2.0},
      {"/asset/version", "2.0.0"},
      {"/asset/minVersion", "3.0"},
      {"/asset/minVersion", "2.1"},
      {"/nodes", json::object()},
      {"/extensionsRequired", "all"},
      {"/extensionsRequired", {"VENDOR_unheard_of"}},
  };
  for (const auto& [pointer, value] : wrong) {
    SCOPED_TRACE(pointer + (" = " + value.dump()));
    GltfBuilder file = full_file();
    file.root[json::json_pointer(pointer)] = value;
    const std::string message = test_support::input_error_of([&] { load(file); });
    EXPECT_NE(message.find("allowed: "), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_LT(message.size(), 600u);
    // A wrong element is named itself, or the array or object that it stands in.
    const std::string parent = std::string(pointer).substr(0, std::string(pointer).rfind('/'));
    const bool is_named = message.find(pointer) != std::string::npos ||
                          message.find(parent + ": ") != std::string::npos ||
                          message.find(parent + "/nodes: ") != std::string::npos;
    EXPECT_TRUE(is_named) << message;
  }
}

TEST_F(GltfSchema, RefusesWhatIsMissing) {
  for (const char* pointer :
       {"/asset", "/asset/version", "/accessors/0/componentType", "/accessors/0/count", "/accessors/0/type",
        "/bufferViews/0/buffer", "/bufferViews/0/byteLength", "/buffers/0/byteLength", "/meshes/0/primitives",
        "/meshes/0/primitives/0/attributes", "/cameras/0/type", "/cameras/0/perspective",
        "/cameras/0/perspective/yfov", "/cameras/0/perspective/znear"}) {
    SCOPED_TRACE(pointer);
    GltfBuilder file = full_file();
    const json::json_pointer place(pointer);
    file.root[place.parent_pointer()].erase(place.back());
    test_support::expect_input_error([&] { load(file); }, {pointer, "found none"});
  }
}

TEST_F(GltfSchema, LetsPassWhatTheSpecificationDoes) {
  for (const auto& [pointer, value] : std::vector<std::pair<const char*, json>>{
           {"/nodes/0/mesh", 0.0},  // JSON Schema takes it for an integer
           {"/nodes/0/extras", {{"anything", {1, "two", nullptr}}}},
           {"/somebody", "else"},
           {"/materials/0/extensions/VENDOR_glow", {{"index", -1}}},
           {"/asset/version", "2.1"},
           {"/asset/minVersion", "2.0"},
           {"/animations", json::array({json{{"channels", -1}}})}}) {
    SCOPED_TRACE(pointer);
    GltfBuilder file = full_file();
    file.root[json::json_pointer(pointer)] = value;
    EXPECT_EQ(load(file).mesh.triangles.size(), 1u);
  }
}

TEST_F(GltfSchema, OfCamerasOnlyTheOneInUseMatters) {
  GltfBuilder file = full_file();
  file.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", -2}, {"znear", 0}}}});
  file.add("cameras", {{"type", "orthographic"}});
  EXPECT_EQ(load(file).camera->camera.vertical_field_of_view_radians, 0.8);
  file.root["nodes"][0]["camera"] = 2;  // comes before the perspective one
  const testbench::GltfFile loaded = load(file);
  EXPECT_EQ(loaded.camera->camera.vertical_field_of_view_radians, 0.8);
  ASSERT_EQ(loaded.mesh.notes.lines().size(), 1u);
  EXPECT_NE(loaded.mesh.notes.lines()[0].find("/cameras/2: an orthographic camera"), std::string::npos);
}

/// The full file with one orthographic camera, 6 units wide and 4 high, in place of its perspective one.
GltfBuilder orthographic_file() {
  GltfBuilder file = full_file();
  file.root["cameras"][0] = {{"type", "orthographic"},
                             {"name", "plan"},
                             {"orthographic", {{"xmag", 3}, {"ymag", 2}, {"znear", 0}, {"zfar", 100}}}};
  return file;
}

TEST_F(GltfSchema, AnOrthographicCameraIsUsedIfThereIsNoOther) {
  GltfBuilder file = orthographic_file();
  const testbench::GltfFile loaded = load(file);
  ASSERT_TRUE(loaded.camera);
  EXPECT_EQ(loaded.camera->camera.orthographic_height, 4.0);
  EXPECT_EQ(loaded.camera->aspect_ratio, 1.5);
  EXPECT_EQ(loaded.camera->camera.position, glm::dvec3(0, 0, 4));
  EXPECT_EQ(loaded.camera->camera.direction, glm::dvec3(0, 0, -1));
  EXPECT_TRUE(loaded.mesh.notes.lines().empty());
  file.root["nodes"][1]["matrix"][0] = file.root["nodes"][1]["matrix"][5] = 7;
  EXPECT_EQ(load(file).camera->camera.orthographic_height, 4.0) << "a node's scale changes no view";
  for (const auto& [pointer, value] :
       std::vector<std::pair<const char*, json>>{{"/cameras/0/orthographic/xmag", 0},
                                                 {"/cameras/0/orthographic/ymag", -1},
                                                 {"/cameras/0/orthographic/ymag", 1e100},
                                                 {"/cameras/0/orthographic/znear", -1},
                                                 {"/cameras/0/orthographic/zfar", "far"},
                                                 {"/cameras/0/orthographic", 3}}) {
    GltfBuilder wrong = orthographic_file();
    wrong.root[json::json_pointer(pointer)] = value;
    test_support::expect_input_error([&, &w = wrong] { load(w); }, {pointer, "allowed: "});
  }
  file.root["cameras"][0].erase("orthographic");
  test_support::expect_input_error([&] { load(file); }, {"/cameras/0/orthographic", "none"});
}

TEST_F(GltfSchema, ASceneFileNamesTheCamera) {
  GltfBuilder file = orthographic_file();
  file.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 1}}}});
  file.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.25}, {"znear", 1}}}});
  file.add_node({{"camera", 1}});
  file.add_node({{"camera", 2}, {"name", "side"}});
  EXPECT_EQ(load(file).camera->camera.vertical_field_of_view_radians, 0.5) << "the first perspective one";
  const auto scene = [&](const std::string& more) {
    return testbench::load_scene(write("scene.toml", "[[mesh]]\nfile = \"a.gltf\"\nscale = 3\n" + more));
  };
  EXPECT_FALSE(scene("").camera.orthographic_height);
  EXPECT_EQ(scene("camera = \"plan\"\n").camera.orthographic_height, 12.0) << "scaled as the mesh is";
  EXPECT_EQ(scene("camera = \"side\"\n").camera.vertical_field_of_view_radians, 0.25) << "its node's name";
  write("tiny.toml", "[[mesh]]\nfile = \"a.gltf\"\nscale = 1e-170\ncamera = \"plan\"\n");
  const testbench::Camera tiny = testbench::load_scene(directory_ / "tiny.toml").camera;
  EXPECT_EQ(tiny.direction, glm::dvec3(0, 0, -1)) << "though the square of the scale is 0";
  EXPECT_NEAR(*tiny.orthographic_height / 4e-170, 1.0, 1e-15);
  test_support::expect_input_error([&] { scene("camera = \"top\"\n"); }, {"a.gltf", "/cameras", "'top'"});
}

TEST_F(GltfSchema, RefusesACameraOutOfReach) {
  GltfBuilder file = full_file();
  file.root["nodes"][1]["matrix"][12] = 1e200;
  test_support::expect_input_error([&] { load(file); }, {"node 1", "too far", "1e100"});
}

TEST_F(GltfSchema, RefusesOneNameTwiceInAnObject) {
  std::string text = full_file().root.dump();
  const std::size_t place = text.find("\"mesh\":0");
  ASSERT_NE(place, std::string::npos);
  text.insert(place, "\"mesh\":0,");
  const auto path = write("a.gltf", text);
  test_support::expect_input_error(
      [&] {
        testbench::load_gltf(path, {testbench::FileReach(path.parent_path()), std::nullopt});
      },
      {"a.gltf", "'mesh' twice"});
}

TEST_F(GltfSchema, RefusesJsonThatNestsTooDeep) {
  GltfBuilder file = full_file();
  std::string text = file.root.dump();
  text.insert(1, "\"extras\":" + std::string(100000, '[') + std::string(100000, ']') + ",");
  const auto path = write("a.gltf", text);
  test_support::expect_input_error(
      [&] {
        testbench::load_gltf(path, {testbench::FileReach(path.parent_path()), std::nullopt});
      },
      {"a.gltf", "64 levels"});
}

TEST_F(GltfSchema, ReadsBuffersBelowItsFolderOnly) {
  GltfBuilder file = full_file();
  for (const char* uri : {"../a.bin", "/etc/passwd", "..%2Fa.bin", "http://a/b", "data:,abc",
                          "data:application/octet-stream;base64,!!!!", "%4", ""}) {
    SCOPED_TRACE(uri);
    file.root["buffers"][0]["uri"] = uri;
    test_support::expect_input_error([&] { load(file); }, {"/buffers/0/uri", "allowed: "});
  }
  file.root["buffers"][0]["uri"] = "%61.bin";
  EXPECT_EQ(load(file).mesh.triangles.size(), 1u);
}

}  // namespace gltf_schema_test
