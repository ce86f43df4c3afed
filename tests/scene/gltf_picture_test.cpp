// What of a glTF file shows in a picture besides plain triangles.

#include <gtest/gtest.h>

#include <cmath>

#include "testbench/scene/gltf_mesh.hpp"
#include "testbench/scene_file/scene_file.hpp"
#include "tests/support/gltf_builder.hpp"
#include "tests/support/image_bytes.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/temporary_directory.hpp"

namespace gltf_picture_test {

using nlohmann::json;
using test_support::GltfBuilder;
using test_support::kGltfCorners;
using testbench::GltfFile;
using testbench::Mesh;
using testbench::Triangle;

class GltfPicture : public test_support::DirectoryFixture {
 protected:
  std::filesystem::path write_file(const GltfBuilder& file) {
    write("a.bin", file.bytes);
    return write("a.gltf", file.root.dump());
  }
  Mesh load(const GltfBuilder& file) {
    const auto path = write_file(file);
    return testbench::load_gltf(path, {testbench::FileReach(directory_), std::nullopt}).mesh;
  }
  void expect_error(const GltfBuilder& file, const std::vector<std::string>& parts) {
    test_support::expect_input_error([&] { load(file); }, parts);
  }
  static void expect_note(const Mesh& mesh, const std::string& part) {
    const std::vector<std::string> lines = mesh.notes.lines();
    ASSERT_EQ(lines.size(), 1u);
    EXPECT_NE(lines[0].find(part), std::string::npos) << lines[0];
  }
};

void expect_corners(const Triangle& triangle, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3* const expected[] = {&a, &b, &c};
  for (int i = 0; i < 3; ++i)
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(triangle.vertex[i][axis], (*expected[i])[axis], 1e-12);
}

/// One triangle, and further attributes of its vertices.
GltfBuilder triangle_file(json attributes = json::object(), json primitive = json::object()) {
  GltfBuilder file;
  attributes["POSITION"] = file.add_accessor("VEC3", 3, kGltfCorners);
  file.add_mesh(attributes, primitive);
  file.add_node({{"mesh", 0}});
  return file;
}

TEST_F(GltfPicture, VertexColoursMultiplyTheBaseColour) {
  GltfBuilder file = triangle_file({}, {{"material", 0}});
  file.add("materials",
           {{"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.25, 1, 1}}, {"metallicFactor", 0}}},
            {"extensions", {{"KHR_materials_transmission", {{"transmissionFactor", 1}}}}}});
  json& attributes = file.root["meshes"][0]["primitives"][0]["attributes"];
  attributes["COLOR_0"] = file.add_accessor<float>("VEC4", 4, {0, 1, 0.5f, 1, 0, 1, 0.5f, 1, 0, 1, 0.5f, 1});
  const Mesh mesh = load(file);
  EXPECT_EQ(mesh.materials.at(0).reflectance, glm::dvec3(0, 0.25, 0.5));
  EXPECT_EQ(mesh.materials.at(0).transmission_colour, glm::dvec3(0, 0.25, 0.5));
  EXPECT_TRUE(mesh.notes.lines().empty());
}

TEST_F(GltfPicture, AverageOfDifferentVertexColoursIsNoted) {
  GltfBuilder file = triangle_file();
  json& attributes = file.root["meshes"][0]["primitives"][0]["attributes"];
  // Components are clamped before the average is taken.
  attributes["COLOR_0"] = file.add_accessor<float>("VEC3", 3, {9, 0, 0, 0, 1, 0, -9, 0, 1});
  const Mesh floats = load(file);
  for (int channel = 0; channel < 3; ++channel)
    EXPECT_NEAR(floats.materials.at(0).reflectance[channel], 1.0 / 3.0, 1e-15);
  expect_note(floats, "a triangle whose vertices differ in colour");
  attributes["COLOR_0"] =
      file.add_accessor<std::uint8_t>("VEC4", 4, {51, 255, 0, 0, 51, 255, 0, 0, 51, 255, 0, 0}, true);
  EXPECT_EQ(load(file).materials.at(0).reflectance, glm::dvec3(0.2, 1, 0));
  attributes["COLOR_0"] = file.add_accessor<std::uint8_t>("VEC3", 3, {1, 1, 1, 1, 1, 1, 1, 1, 1});
  expect_error(file, {"COLOR_0", "5121", "normalized"});
  attributes["COLOR_0"] = file.add_accessor<float>("VEC3", 3, {1, 1, 1});
  expect_error(file, {"COLOR_0", "1 elements", "3, one for each vertex"});
}

TEST_F(GltfPicture, MorphTargetsCountAtTheirWeights) {
  GltfBuilder file = triangle_file();
  const std::size_t target = file.add_accessor<float>("VEC3", 3, {1, 0, 0, 1, 0, 0, 1, 0, 2});
  file.root["meshes"][0]["primitives"][0]["targets"] = json::array({json{{"POSITION", target}}});
  expect_corners(load(file).triangles.at(0), {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  file.root["meshes"][0]["weights"] = {0.5};
  expect_corners(load(file).triangles.at(0), {0.5, 0, 0}, {1.5, 0, 0}, {0.5, 1, 1});
  file.root["nodes"][0]["weights"] = {2};  // a node's weights go before its mesh's
  expect_corners(load(file).triangles.at(0), {2, 0, 0}, {3, 0, 0}, {2, 1, 4});
  file.root["nodes"][0]["weights"] = {2, 1};
  expect_error(file, {"2 weights", "1, one for each"});
}

TEST_F(GltfPicture, SkinsFollowTheirJoints) {
  GltfBuilder file = triangle_file();
  json& attributes = file.root["meshes"][0]["primitives"][0]["attributes"];
  attributes["JOINTS_0"] = file.add_accessor<std::uint8_t>("VEC4", 4, {0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0});
  attributes["WEIGHTS_0"] = file.add_accessor<float>("VEC4", 4, {1, 0, 0, 0, 0, 1, 0, 0, 0.5f, 0.5f, 0, 0});
  std::vector<float> inverses(32, 0.0f);
  for (const std::size_t place : {0, 5, 10, 15, 16, 21, 26, 31}) inverses[place] = 1.0f;
  inverses[12] = -1.0f;  // the first joint was bound at x = 1
  const std::size_t matrices = file.add_accessor("MAT4", 16, inverses);
  file.add_node({{"translation", {1, 0, 5}}, {"children", {2}}});
  file.add("nodes", {{"translation", {-1, 0, -2}}});
  file.root["nodes"][0]["skin"] = file.add("skins", {{"joints", {1, 2}}, {"inverseBindMatrices", matrices}});
  file.root["nodes"][0]["translation"] = {100, 0, 0};  // a skinned mesh does not follow its own node
  expect_corners(load(file).triangles.at(0), {0, 0, 5}, {1, 0, 3}, {0, 1, 4});
  attributes["JOINTS_0"] = file.add_accessor<std::uint8_t>("VEC4", 4, {0, 2, 0, 0, 0, 2, 0, 0, 0, 2, 0, 0});
  expect_error(file, {"joint 2", "joints 0 to 1"});
  attributes.erase("WEIGHTS_0");
  expect_error(file, {"only one of JOINTS_0 and WEIGHTS_0"});
}

TEST_F(GltfPicture, InstancesAppearEach) {
  GltfBuilder file = triangle_file();
  const std::size_t places = file.add_accessor<float>("VEC3", 3, {0, 0, 1, 0, 0, 2});
  const std::size_t scales = file.add_accessor<float>("VEC3", 3, {1, 1, 1, 2, 2, 2});
  file.root["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  json& attributes = file.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
  attributes = {{"TRANSLATION", places}, {"SCALE", scales}};
  file.root["nodes"][0]["translation"] = {5, 0, 0};
  const std::vector<Triangle> triangles = load(file).triangles;
  ASSERT_EQ(triangles.size(), 2u);
  expect_corners(triangles[0], {5, 0, 1}, {6, 0, 1}, {5, 1, 1});
  expect_corners(triangles[1], {5, 0, 2}, {7, 0, 2}, {5, 2, 2});
  attributes["SCALE"] = file.add_accessor<float>("VEC3", 3, {1, 1, 1});
  expect_error(file, {"EXT_mesh_gpu_instancing", "one number of instances"});
  attributes = {{"TRANSLATION",
                 file.add("accessors", {{"componentType", 5126}, {"count", 2000000}, {"type", "VEC3"}})}};
  expect_error(file, {"EXT_mesh_gpu_instancing", "2000000 instances", "at most 1048576"});
}

TEST_F(GltfPicture, QuantizedPositionsNeedTheirExtension) {
  GltfBuilder file = triangle_file();
  json& attributes = file.root["meshes"][0]["primitives"][0]["attributes"];
  attributes["POSITION"] = file.add_accessor<std::int8_t>("VEC3", 3, {0, 0, 0, 127, 0, 0, 0, -128, 0}, true);
  expect_error(file, {"POSITION", "5120 normalized", "5126"});
  file.root["extensionsUsed"] = {"KHR_mesh_quantization"};
  expect_corners(load(file).triangles.at(0), {0, 0, 0}, {1, 0, 0}, {0, -1, 0});
  attributes["POSITION"] = file.add_accessor<std::uint16_t>("VEC3", 3, {0, 0, 0, 65535, 0, 0, 0, 7, 0});
  expect_corners(load(file).triangles.at(0), {0, 0, 0}, {65535, 0, 0}, {0, 7, 0});
}

TEST_F(GltfPicture, SparseAccessorsReplaceElements) {
  GltfBuilder file = triangle_file();
  const std::size_t places = file.add_view<std::uint16_t>({1, 2});
  const std::size_t values = file.add_view<float>({3, 0, 0, 0, 4, 0});
  json sparse{{"count", 2},
              {"indices", {{"bufferView", places}, {"componentType", 5123}}},
              {"values", {{"bufferView", values}}}};
  file.root["accessors"][0]["sparse"] = sparse;
  expect_corners(load(file).triangles.at(0), {0, 0, 0}, {3, 0, 0}, {0, 4, 0});
  file.root["accessors"][0].erase("bufferView");  // zeros then
  expect_corners(load(file).triangles.at(0), {0, 0, 0}, {3, 0, 0}, {0, 4, 0});
  file.root["accessors"][0]["sparse"]["indices"]["bufferView"] = file.add_view<std::uint16_t>({1, 3});
  expect_error(file, {"sparse indices", "found 3", "0 to 2"});
  file.root["accessors"][0]["sparse"]["indices"]["bufferView"] = file.add_view<std::uint16_t>({1, 1});
  expect_error(file, {"sparse indices", "rising"});
  file.root["accessors"][0]["sparse"]["count"] = 4;
  expect_error(file, {"sparse", "4 elements", "at most 3"});
}

TEST_F(GltfPicture, MaskCutsOutByAlpha) {
  GltfBuilder file = triangle_file({}, {{"material", 0}});
  file.add("materials",
           {{"alphaMode", "MASK"},
            {"pbrMetallicRoughness", {{"baseColorFactor", {1, 0, 0, 0.6}}, {"metallicFactor", 0}}}});
  EXPECT_EQ(load(file).triangles.size(), 1u);  // 0.6 is above the default cutoff of 0.5
  file.root["materials"][0]["alphaCutoff"] = 0.7;
  expect_error(file, {"no triangle", "1 cut out"});
  file.root["materials"][0]["alphaCutoff"] = 0.6;  // equal is not below
  EXPECT_EQ(load(file).triangles.size(), 1u);
  file.root["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] =
      file.add_accessor<float>("VEC4", 4, {1, 1, 1, 0.5f, 1, 1, 1, 0.5f, 1, 1, 1, 0.5f});
  expect_error(file, {"1 cut out"});
}

TEST_F(GltfPicture, SaysWhatItLeavesOut) {
  GltfBuilder other = triangle_file({}, {{"material", 0}});
  other.add("materials", {{"extensions", {{"KHR_materials_iridescence", json::object()}}}});
  expect_note(load(other), "KHR_materials_iridescence");
  GltfBuilder lines = triangle_file();
  json& primitives = lines.root["meshes"][0]["primitives"];
  for (const int mode : {1, 2, 3}) primitives.push_back({{"attributes", {{"POSITION", 0}}}, {"mode", mode}});
  expect_note(load(lines), "lines are left out, 3 times");
}

/// A square that emits, and a camera on one side of it that sees only the square.
GltfBuilder square_light(double camera_z, bool is_double_sided) {
  GltfBuilder file;
  const std::size_t points = file.add_accessor<float>("VEC3", 3, {-5, -5, 0, 5, -5, 0, 5, 5, 0, -5, 5, 0});
  const std::size_t indices = file.add_accessor<std::uint16_t>("SCALAR", 1, {0, 1, 2, 0, 2, 3});
  file.add("materials", {{"doubleSided", is_double_sided},
                         {"emissiveFactor", {0.25, 0.5, 1}},
                         {"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.5, 0.5, 1}}}}});
  file.add_mesh({{"POSITION", points}}, {{"indices", indices}, {"material", 0}});
  file.add_node(
      {{"mesh", 0}, {"rotation", {0.48, 0.6, 0, 0.64}}, {"translation", {0.3, 7, -2}}, {"children", {1}}});
  file.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.8}, {"znear", 0.1}}}});
  json camera{{"camera", 0}, {"translation", {0, 0, camera_z}}};
  if (camera_z < 0) camera["rotation"] = {0, 1, 0, 0};
  file.add("nodes", camera);
  return file;
}

/// Every path of every program sees the whole radiance on either side: no sheet hides the other.
TEST_F(GltfPicture, DoubleSidedLightsEmitFromBothSides) {
  for (const path_tracer::Program program : {path_tracer::Program::full, path_tracer::Program::segments}) {
    for (const double z : {4.0, -4.0, 400.0, -400.0}) {
      SCOPED_TRACE(z);
      GltfBuilder file = square_light(z, true);
      if (std::abs(z) > 100) file.root["cameras"][0]["perspective"]["yfov"] = 0.008;
      testbench::Scene scene = testbench::load_scene(write_file(file));
      scene.film = {16, 16};
      EXPECT_EQ(scene.triangles.size(), 4u);
      for (const auto& path : test_support::native_paths(scene, test_support::render_options(program, 1))) {
        EXPECT_EQ(path.radiance.x, 0.25);
        EXPECT_EQ(path.radiance.z, 1.0);
      }
    }
  }
}

/// Its two sheets are one surface to a ray: seen from either side, it is there a quarter of the time.
TEST_F(GltfPicture, DoubleSidedLightsOfPartialCoverageAreThereOnce) {
  for (const double z : {4.0, -4.0}) {
    GltfBuilder file = square_light(z, true);
    file.root["materials"][0]["alphaMode"] = "BLEND";
    file.root["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"][3] = 0.25;
    testbench::Scene scene = testbench::load_scene(write_file(file));
    scene.film = {64, 64};
    double mean = 0.0;
    for (const auto& path :
         test_support::native_paths(scene, test_support::render_options(path_tracer::Program::segments, 4)))
      mean += path.radiance.z / (64 * 64 * 4);
    // Standard deviation: sqrt(0.25 * 0.75 / 16384).
    EXPECT_NEAR(mean, 0.25, 5 * 0.0034) << z;
  }
}

TEST_F(GltfPicture, OtherLightsEmitFromTheirFrontOnly) {
  testbench::Scene scene = testbench::load_scene(write_file(square_light(-4.0, false)));
  scene.film = {8, 8};
  EXPECT_EQ(scene.triangles.size(), 2u);
  for (const auto& path :
       test_support::native_paths(scene, test_support::render_options(path_tracer::Program::full, 1)))
    EXPECT_EQ(path.radiance.z, 0.0);
}

}  // namespace gltf_picture_test
