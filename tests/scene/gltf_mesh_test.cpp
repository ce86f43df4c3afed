#include "testbench/scene/gltf_mesh.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <glm/gtc/constants.hpp>
#include <limits>
#include <random>

#include "testbench/scene_file/scene_file.hpp"
#include "testbench/system/error.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/temporary_directory.hpp"

namespace gltf_mesh_test {

using testbench::GltfFile;
using testbench::InputError;
using testbench::Triangle;

/// A small file whose parts tests change: a triangle at z = 0 that faces +z. Its buffer holds 3 points and
/// the 3 indices in 8, 16 and 32 bits.
struct Gltf {
  std::string asset = R"("asset":{"version":"2.0"})";
  std::string scenes = R"("scenes":[{"nodes":[0]}])";
  std::string nodes = R"("nodes":[{"mesh":0}])";
  std::string meshes =
      R"("meshes":[{"name":"tri","primitives":[{"attributes":{"POSITION":0},"indices":1}]}])";
  std::string materials = R"("materials":[])";
  std::string accessors =
      R"("accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},)"
      R"({"bufferView":1,"componentType":5121,"count":3,"type":"SCALAR"},)"
      R"({"bufferView":1,"byteOffset":4,"componentType":5123,"count":3,"type":"SCALAR"},)"
      R"({"bufferView":1,"byteOffset":12,"componentType":5125,"count":4,"type":"SCALAR"}])";
  std::string views =
      R"("bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":28}])";
  std::string buffers = R"("buffers":[{"byteLength":76,"uri":"a.bin"}])";
  std::string more;
  std::vector<float> points{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
  std::vector<std::uint8_t> bytes{0, 1, 2, 0};
  std::vector<std::uint16_t> words{0, 1, 2, 0};
  std::vector<std::uint32_t> long_words{0, 1, 2, 3};

  std::string json() const {
    std::string text = "{" + asset;
    for (const std::string& part : {scenes, nodes, meshes, materials, accessors, views, buffers, more})
      if (!part.empty()) text += "," + part;
    return text + "}";
  }
  std::string binary() const {
    std::string data;
    const auto append = [&data](const auto& values) {
      data.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(values[0]));
    };
    append(points);
    append(bytes);
    append(words);
    append(long_words);
    return data;
  }
  /// The same as .glb, with the buffer in the file's own chunk.
  std::string glb() const {
    Gltf embedded = *this;
    embedded.buffers = R"("buffers":[{"byteLength":76}])";
    std::string text = embedded.json();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const std::string data = binary();
    const auto word = [](std::size_t value) {
      const auto number = static_cast<std::uint32_t>(value);
      return std::string(reinterpret_cast<const char*>(&number), 4);
    };
    return "glTF" + word(2) + word(12 + 8 + text.size() + 8 + data.size()) + word(text.size()) + "JSON" +
           text + word(data.size()) + std::string("BIN\0", 4) + data;
  }
};

GltfFile load_gltf(const std::filesystem::path& file) {
  return testbench::load_gltf(file, {testbench::FileReach(file.parent_path()), std::nullopt});
}

class GltfMesh : public test_support::DirectoryFixture {
 protected:
  using DirectoryFixture::write;
  std::filesystem::path write(const Gltf& gltf) {
    write("a.bin", gltf.binary());
    return write("a.gltf", gltf.json());
  }
  GltfFile load(const Gltf& gltf) { return load_gltf(write(gltf)); }

  static std::string error_of(const std::filesystem::path& file) {
    return test_support::input_error_of([&] { load_gltf(file); });
  }
  void expect_error(const Gltf& gltf, std::vector<std::string> parts) {
    parts.insert(parts.end(), {"a.gltf: ", "allowed: "});
    test_support::expect_input_error([&] { load_gltf(write(gltf)); }, parts);
  }
};

void expect_triangle(const Triangle& triangle, const glm::dvec3& a, const glm::dvec3& b,
                     const glm::dvec3& c) {
  const glm::dvec3* const expected[] = {&a, &b, &c};
  for (int i = 0; i < 3; ++i)
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(triangle.vertex[i][axis], (*expected[i])[axis], 1e-12);
}

TEST_F(GltfMesh, ReadsATriangleByIndicesOfEveryWidth) {
  for (const char* indices : {"1", "2", "3"}) {
    Gltf gltf;
    gltf.meshes =
        R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":)" + std::string(indices) + "}]}]";
    const GltfFile file = load(gltf);
    ASSERT_EQ(file.mesh.triangles.size(), 1u);
    expect_triangle(file.mesh.triangles[0], {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    EXPECT_FALSE(file.camera);
  }
}

TEST_F(GltfMesh, ReadsWithoutIndicesAndWithStrides) {
  Gltf gltf;
  gltf.meshes = R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}])";
  gltf.accessors = R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}])";
  EXPECT_EQ(load(gltf).mesh.triangles.size(), 1u);
  gltf.views = R"("bufferViews":[{"buffer":0,"byteLength":48,"byteStride":16}])";
  gltf.points = {0, 0, 0, 9, 1, 0, 0, 9, 0, 1, 0, 9};
  expect_triangle(load(gltf).mesh.triangles.at(0), {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
}

/// All triangles have the same winding.
TEST_F(GltfMesh, CutsStripsAndFans) {
  Gltf gltf;
  gltf.meshes = R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":3,"mode":5}]}])";
  const auto strip = load(gltf).mesh.triangles;
  ASSERT_EQ(strip.size(), 2u);
  expect_triangle(strip[1], {1, 0, 0}, {1, 1, 0}, {0, 1, 0});
  gltf.meshes = R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":3,"mode":6}]}])";
  gltf.long_words = {0, 1, 3, 2};
  const auto fan = load(gltf).mesh.triangles;
  ASSERT_EQ(fan.size(), 2u);
  expect_triangle(fan[1], {1, 1, 0}, {0, 1, 0}, {0, 0, 0});
}

TEST_F(GltfMesh, LeavesOutPointsAndLines) {
  Gltf gltf;
  gltf.meshes = R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"mode":0},)"
                R"({"attributes":{"POSITION":0},"mode":1},{"attributes":{"POSITION":0},"indices":1}]}])";
  EXPECT_EQ(load(gltf).mesh.triangles.size(), 1u);
}

TEST_F(GltfMesh, MovesAMeshByEveryNodeAboveIt) {
  Gltf gltf;
  gltf.nodes = R"("nodes":[{"translation":[10,0,0],"children":[1]},)"
               R"({"rotation":[0,0,0.70710678118654752,0.70710678118654752],"children":[2]},)"
               R"({"scale":[2,3,4],"mesh":0}])";
  expect_triangle(load(gltf).mesh.triangles.at(0), {10, 0, 0}, {10, 2, 0}, {7, 0, 0});
  gltf.nodes = R"("nodes":[{"matrix":[2,0,0,0, 0,3,0,0, 0,0,4,0, 5,6,7,1],"mesh":0}])";
  expect_triangle(load(gltf).mesh.triangles.at(0), {5, 6, 7}, {7, 6, 7}, {5, 9, 7});
}

TEST_F(GltfMesh, HoldsAMeshAsOftenAsNodesDo) {
  Gltf gltf;
  gltf.scenes = R"("scenes":[{"nodes":[0,1]}])";
  gltf.nodes = R"("nodes":[{"mesh":0},{"mesh":0,"translation":[0,0,5]}])";
  const auto triangles = load(gltf).mesh.triangles;
  ASSERT_EQ(triangles.size(), 2u);
  EXPECT_EQ(triangles[1].vertex[0].z, 5.0);
}

TEST_F(GltfMesh, TurnsMirroredTrianglesRight) {
  Gltf gltf;
  gltf.nodes = R"("nodes":[{"mesh":0,"scale":[-1,1,1]}])";
  expect_triangle(load(gltf).mesh.triangles.at(0), {0, 0, 0}, {0, 1, 0}, {-1, 0, 0});
}

TEST_F(GltfMesh, WithoutASceneTakesTheNodesThatHaveNoParent) {
  Gltf gltf;
  gltf.scenes = "";
  gltf.nodes = R"("nodes":[{"mesh":0,"translation":[0,0,1]},{"children":[0],"translation":[0,0,2]}])";
  const auto triangles = load(gltf).mesh.triangles;
  ASSERT_EQ(triangles.size(), 1u);
  EXPECT_EQ(triangles[0].vertex[0].z, 3.0);
}

TEST_F(GltfMesh, ReadsColoursAndTheStrengthOfLights) {
  Gltf gltf;
  gltf.meshes = R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":1},)"
                R"({"attributes":{"POSITION":0},"indices":1}]}])";
  gltf.materials = R"("materials":[{"name":"unused"},{"name":"lamp","emissiveFactor":[1,0.5,0.25],)"
                   R"("pbrMetallicRoughness":{"baseColorFactor":[0.1,0.2,0.3,1]},)"
                   R"("extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":40}}}])";
  const auto mesh = load(gltf).mesh;
  ASSERT_EQ(mesh.materials.size(), 2u);
  EXPECT_EQ(mesh.materials[0].name, "lamp");
  EXPECT_EQ(mesh.materials[0].reflectance, glm::dvec3(0.1, 0.2, 0.3));
  EXPECT_EQ(mesh.materials[0].emission, glm::dvec3(40, 20, 10));
  EXPECT_EQ(mesh.materials[1].reflectance, glm::dvec3(1.0));
  EXPECT_EQ(mesh.triangles[0].material, 0);
  EXPECT_EQ(mesh.triangles[1].material, 1);
}

constexpr const char* kCameras =
    R"("cameras":[{"type":"perspective","perspective":{"yfov":0.5,"znear":0.1,"aspectRatio":1.5}}])";

TEST_F(GltfMesh, FindsTheCameraThatANodeHolds) {
  Gltf gltf;
  gltf.scenes = R"("scenes":[{"nodes":[0,1]}])";
  gltf.nodes = R"("nodes":[{"mesh":0},{"camera":0,"translation":[1,2,3],"rotation":[0,1,0,0]}])";
  gltf.more = kCameras;
  const GltfFile file = load(gltf);
  ASSERT_TRUE(file.camera);
  EXPECT_EQ(file.camera->camera.position, glm::dvec3(1, 2, 3));
  EXPECT_NEAR(file.camera->camera.direction.z, 1.0, 1e-15);  // turned by 180 degrees about y
  EXPECT_NEAR(file.camera->camera.up.y, 1.0, 1e-15);
  EXPECT_EQ(file.camera->camera.vertical_field_of_view_radians, 0.5);
  EXPECT_EQ(file.camera->aspect_ratio, 1.5);
}

TEST_F(GltfMesh, WithACameraAndALightIsASceneOfItsOwn) {
  Gltf gltf;
  gltf.scenes = R"("scenes":[{"nodes":[0,1]}])";
  gltf.nodes = R"("nodes":[{"mesh":0},{"camera":0,"translation":[0,0,3]}])";
  gltf.meshes = R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]}])";
  gltf.materials = R"("materials":[{"emissiveFactor":[1,1,1]}])";
  gltf.more = kCameras;
  const testbench::Scene scene = testbench::load_scene(write(gltf));
  EXPECT_EQ(scene.name, "a");
  EXPECT_EQ(scene.film.width, 720);
  EXPECT_EQ(scene.film.height, 480);
  EXPECT_EQ(scene.camera.position, glm::dvec3(0, 0, 3));
}

// It was refused. Exported files often hold a camera and no light that has an area, and a viewer lights them.
TEST_F(GltfMesh, WithACameraAndNoLightGetsTheDefaultLight) {
  Gltf gltf;
  gltf.scenes = R"("scenes":[{"nodes":[0,1]}])";
  gltf.nodes = R"("nodes":[{"mesh":0},{"camera":0,"translation":[0,0,3]}])";
  gltf.more = kCameras;
  const testbench::Scene scene = testbench::load_scene(write(gltf));
  EXPECT_EQ(scene.camera.position, glm::dvec3(0, 0, 3));
  ASSERT_EQ(scene.triangles.size(), 3u);
  EXPECT_GT(scene.materials.at(std::size_t(scene.triangles[1].material)).emission.x, 0.0);
  for (const glm::dvec3& vertex : scene.triangles[1].vertex) EXPECT_GT(vertex.z, 3.0) << "behind the camera";
  ASSERT_EQ(scene.notes.lines().size(), 1u);
  EXPECT_NE(scene.notes.lines()[0].find("a.gltf: no triangle emits"), std::string::npos);
}

TEST_F(GltfMesh, LendsItsCameraToASceneFile) {
  Gltf gltf;
  gltf.scenes = R"("scenes":[{"nodes":[0,1]}])";
  gltf.nodes = R"("nodes":[{"mesh":0},{"camera":0,"translation":[0,0,3]}])";
  gltf.meshes = R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]}])";
  gltf.materials = R"("materials":[{"emissiveFactor":[1,1,1]}])";
  gltf.more = kCameras;
  write(gltf);
  const auto scene = testbench::load_scene(
      write("scene.toml", "[[mesh]]\nfile = \"a.gltf\"\nscale = 2\ntranslate = [1, 0, 0]\n"));
  EXPECT_EQ(scene.camera.position, glm::dvec3(1, 0, 6));
  expect_triangle(scene.triangles.at(0), {1, 0, 0}, {3, 0, 0}, {1, 2, 0});
}

TEST_F(GltfMesh, ReadsTheBinaryForm) {
  const GltfFile file = load_gltf(write("a.glb", Gltf{}.glb()));
  ASSERT_EQ(file.mesh.triangles.size(), 1u);
  expect_triangle(file.mesh.triangles[0], {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
}

TEST_F(GltfMesh, RefusesABinaryFileCutOffAnywhere) {
  const std::string whole = Gltf{}.glb();
  for (std::size_t bytes = 0; bytes < whole.size(); bytes += 7) {
    const std::string message = error_of(write("a.glb", whole.substr(0, bytes)));
    EXPECT_NE(message, "") << bytes;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

/// Any content of a file gives a mesh or one line of error, never a crash.
TEST_F(GltfMesh, SurvivesDamagedFiles) {
  const std::string whole = Gltf{}.glb();
  std::mt19937 random(1);
  for (int round = 0; round < 3000; ++round) {
    std::string damaged = whole;
    for (unsigned i = 0; i < 1 + random() % 3; ++i)
      damaged[random() % damaged.size()] = static_cast<char>(random());
    const std::string message = error_of(write("a.glb", damaged));
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

TEST_F(GltfMesh, NamesIndicesThatPointNowhere) {
  const auto with = [](std::string Gltf::*part, const std::string& text) {
    Gltf gltf;
    gltf.*part = text;
    return gltf;
  };
  expect_error(with(&Gltf::scenes, R"("scenes":[{"nodes":[7]}])"), {"node 7", "0 to 0"});
  expect_error(with(&Gltf::nodes, R"("nodes":[{"mesh":3}])"), {"mesh 3", "0 to 0"});
  expect_error(with(&Gltf::nodes, R"("nodes":[{"mesh":0,"children":[-2]}])"), {"node -2"});
  expect_error(with(&Gltf::nodes, R"("nodes":[{"mesh":0,"camera":0}])"), {"camera 0", "none"});
  expect_error(with(&Gltf::meshes, R"("meshes":[{"primitives":[{"attributes":{"POSITION":9}}]}])"),
               {"accessor 9", "0 to 3"});
  expect_error(
      with(&Gltf::meshes, R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":2}]}])"),
      {"material 2"});
  expect_error(with(&Gltf::meshes, R"("meshes":[{"primitives":[{"attributes":{"NORMAL":0}}]}])"),
               {"POSITION"});
  expect_error(with(&Gltf::views, R"("bufferViews":[{"buffer":0,"byteLength":48}])"),
               {"/accessors/1/bufferView", "bufferView 1", "0 to 0"});
  Gltf vertex;
  vertex.bytes = {0, 1, 4, 0};
  expect_error(vertex, {"vertex 4", "0 to 3"});
}

TEST_F(GltfMesh, NamesRangesBeyondTheBuffer) {
  Gltf gltf;
  gltf.views = R"("bufferViews":[{"buffer":0,"byteLength":47},{"buffer":0,"byteOffset":48,"byteLength":28}])";
  expect_error(gltf, {"beyond the end"});
  gltf.views = R"("bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":60,"byteLength":28}])";
  expect_error(gltf, {"beyond the end"});
  Gltf many;
  many.meshes = R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}])";
  many.accessors =
      R"("accessors":[{"bufferView":0,"componentType":5126,"count":4611686018427387904,"type":"VEC3"}])";
  expect_error(many, {"beyond the end"});
}

TEST_F(GltfMesh, NamesCoordinatesThatAreNoNumbers) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    Gltf gltf;
    gltf.points[4] = bad;
    expect_error(gltf, {"mesh 0 'tri'", "no number", "1e100"});
  }
}

TEST_F(GltfMesh, RefusesNodesThatAreNoTree) {
  Gltf gltf;
  gltf.nodes = R"("nodes":[{"mesh":0,"children":[1]},{"name":"loop","children":[0]}])";
  expect_error(gltf, {"node 0", "one parent"});
  gltf.nodes = R"("nodes":[{"mesh":0,"children":[1,2]},{"children":[2]},{"name":"shared"}])";
  expect_error(gltf, {"node 2 'shared'", "one parent"});
}

TEST_F(GltfMesh, WalksALongChainOfNodes) {
  Gltf gltf;
  constexpr int kNodes = 20000;
  gltf.nodes = R"("nodes":[)";
  for (int i = 0; i + 1 < kNodes; ++i)
    gltf.nodes += R"({"translation":[0,0,1],"children":[)" + std::to_string(i + 1) + "]},";
  gltf.nodes += R"({"mesh":0}])";
  EXPECT_EQ(load(gltf).mesh.triangles.at(0).vertex[0].z, kNodes - 1);
}

TEST_F(GltfMesh, RefusesWhatItCannotShow) {
  Gltf missing;
  missing.materials =
      R"("materials":[{"name":"wood","pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}])";
  expect_error(missing, {"/materials/0/pbrMetallicRoughness/baseColorTexture/index", "texture 0", "none"});
  Gltf bright;
  bright.materials = R"("materials":[{"pbrMetallicRoughness":{"baseColorFactor":[1,2,1,1]}}])";
  expect_error(bright, {"/materials/0/pbrMetallicRoughness/baseColorFactor/1", "found 2", "0 to 1"});
  Gltf unknown;
  unknown.more = R"("extensionsRequired":["KHR_texture_transform"])";
  expect_error(unknown, {"extensionsRequired", "KHR_texture_transform", "KHR_mesh_quantization"});
  Gltf flat;
  flat.points = {0, 0, 0, 1, 0, 0, 2, 0, 0, 0, 0, 0};
  expect_error(flat, {"no triangle", "1 without area"});
}

TEST_F(GltfMesh, RefusesFilesThatAreNoGltf) {
  EXPECT_NE(error_of(directory_ / "gone.gltf").find("no file that can be read"), std::string::npos);
  EXPECT_NE(error_of(directory_).find("no file that can be read"), std::string::npos);
  for (const char* text : {"", "{", "[]", "not JSON", "{\"asset\":{\"version\":\"1.0\"}}", "{\"nodes\":3}"}) {
    const std::string message = error_of(write("a.gltf", text));
    EXPECT_NE(message.find("a.gltf: "), std::string::npos) << text << message;
    EXPECT_NE(message.find("found "), std::string::npos) << text << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
  Gltf gltf;
  write(gltf);
  std::filesystem::remove(directory_ / "a.bin");
  EXPECT_NE(error_of(write("b.gltf", gltf.json())), "");
}

}  // namespace gltf_mesh_test
