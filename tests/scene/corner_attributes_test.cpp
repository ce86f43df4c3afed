// Normals and texture coordinates of corners: of every format, moved with their triangles, and in step with
// them.

#include "testbench/scene/corner_attributes.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "testbench/scene/gltf_mesh.hpp"
#include "testbench/scene_file/scene_file.hpp"
#include "tests/support/gltf_builder.hpp"
#include "tests/support/image_bytes.hpp"
#include "tests/support/temporary_directory.hpp"

namespace corner_attributes_test {

using test_support::GltfBuilder;
using testbench::CornerNormals;
using testbench::Scene;

constexpr const char* kCamera =
    "[camera]\nposition = [0, 0, 9]\nlook_at = [0, 0, 0]\nvertical_fov_degrees = 40\n";

class CornerAttributesTest : public test_support::DirectoryFixture {
 protected:
  /// A scene of m.obj, whose material is textured and emits.
  Scene load(const std::string& obj, const std::string& of_mesh = "") {
    write("t.png", test_support::png_bytes(1, 1, {1, 2, 3}));
    write("m.mtl", "newmtl t\nKd 1 1 1\nmap_Kd t.png\nKe 1 1 1\n");
    write("m.obj", "mtllib m.mtl\nusemtl t\n" + obj);
    return testbench::load_scene(
        write("scene.toml", kCamera + std::string("[[mesh]]\nfile = \"m.obj\"\n") + of_mesh));
  }
  /// The scene of one triangle of glTF, whose vertices have the given normal.
  Scene load_gltf(const glm::vec3& normal, nlohmann::json node, const char* more = nullptr) {
    GltfBuilder file;
    std::vector<float> normals;
    for (int i = 0; i < 3; ++i) normals.insert(normals.end(), {normal.x, normal.y, normal.z});
    const std::size_t positions = file.add_accessor("VEC3", 3, test_support::kGltfCorners);
    file.add_mesh({{"POSITION", positions}, {"NORMAL", file.add_accessor<float>("VEC3", 3, normals)}},
                  {{"material", 0}});
    file.add("materials", {{"emissiveFactor", {1, 1, 1}}});
    if (more != nullptr) file.root["meshes"][0].update(nlohmann::json::parse(more));
    node["mesh"] = 0;
    file.add_node(node);
    write("a.bin", file.bytes);
    return testbench::load_scene(write("a.gltf", file.root.dump()));
  }
};

void expect_near(const glm::dvec3& found, const glm::dvec3& expected) {
  EXPECT_NEAR(glm::distance(found, glm::normalize(expected)), 0.0, 1e-7)
      << found.x << " " << found.y << " " << found.z;
}

constexpr const char* kTilted = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvn 3 0 4\nvn 0 0.6 0.8\nvn 0 0 1\n";

TEST_F(CornerAttributesTest, ObjNormalsHaveUnitLengthAndStandOnTheFront) {
  const Scene scene =
      load(std::string(kTilted) + "f 1//1 2//2 3//3\nf 2//-3 3//-2 4//-1\nf 3//1 2//2 4//3\n");
  ASSERT_EQ(scene.corners.normals.size(), 3u);
  expect_near(scene.corners.normals[0][0], {0.6, 0, 0.8});
  expect_near(scene.corners.normals[0][1], {0, 0.6, 0.8});
  expect_near(scene.corners.normals[0][2], {0, 0, 1});
  expect_near(scene.corners.normals[1][0], {-0.6, 0, -0.8});  // the second triangle's front is -z
  expect_near(scene.corners.normals[2][0], {0.6, 0, 0.8});
}

TEST_F(CornerAttributesTest, NormalsOfAFlatSurfaceAreDropped) {
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 1 0\nvn 0 0 1\nvn 0.0003 0 1\nvn 0 0 0\n";
  EXPECT_TRUE(load(points + "f 1//1 2//1 3//1\n").corners.is_empty());
  EXPECT_TRUE(load(points + "f 1 2 3\n").corners.is_empty());
  EXPECT_TRUE(load(points + "f 1//2 2//3 3//2\n").corners.is_empty());  // one is no direction
  const Scene bent = load(points + "f 1//1 2//1 3//1\nf 1//1 2//2 3//2\nf 4//1 2//1 3//1\n");
  ASSERT_EQ(bent.corners.normals.size(), bent.triangles.size());
  ASSERT_EQ(bent.triangles.size(), 2u);  // the second repeats the first
}

TEST_F(CornerAttributesTest, PolygonsKeepWhatTheirCornersHave) {
  const std::string square = "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
  const Scene scene = load(square + "f 1/1 2/2 3/3 4/4\n");
  ASSERT_EQ(scene.corners.coordinates[0].size(), 2u);
  EXPECT_TRUE(scene.corners.coordinates[1].empty());
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const glm::dvec3& place = scene.triangles[i].vertex[corner];
      EXPECT_EQ(scene.corners.coordinates[0][i][corner], glm::dvec2(place.x / 4.0, 1.0 - place.y / 4.0));
    }
}

/// A star without a fan, which GLU cuts.
TEST_F(CornerAttributesTest, ConcavePolygonsKeepWhatTheirCornersHave) {
  std::string text;
  std::string face = "f";
  for (int i = 0; i < 14; ++i) {
    const double angle = i * 3.14159265358979 / 7.0;
    const double radius = i % 2 == 0 ? 3.0 : 0.5;
    const std::string x = std::to_string(radius * std::cos(angle));
    const std::string y = std::to_string(radius * std::sin(angle));
    text += "v " + x + " " + y + " 0\nvt " + x + " " + y + "\n";
    face += " " + std::to_string(i + 1) + "/" + std::to_string(i + 1);
  }
  const Scene scene = load(text + face + "\n");
  ASSERT_EQ(scene.triangles.size(), 12u);
  ASSERT_EQ(scene.corners.coordinates[0].size(), 12u);
  for (std::size_t i = 0; i < 12; ++i)
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const glm::dvec3& place = scene.triangles[i].vertex[corner];
      EXPECT_EQ(scene.corners.coordinates[0][i][corner], glm::dvec2(place.x, 1.0 - place.y));
    }
}

/// Degenerate and repeated triangles go with what their corners have.
TEST_F(CornerAttributesTest, StayInStepWithTriangles) {
  const Scene scene = load(
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nv 0 2 0\nvt 0.25 0\nvt 0.5 0\nvt 0.75 0\n"
      "f 1 2 4\nf 1/1 2/1 3/1\nf 1/2 2/2 3/2\nf 1 4 3\nf 1/3 2/3 5/3\n");
  ASSERT_EQ(scene.triangles.size(), 3u);
  ASSERT_EQ(scene.corners.coordinates[0].size(), 3u);
  EXPECT_EQ(scene.corners.coordinates[0][0][0].x, 0.25);
  EXPECT_EQ(scene.corners.coordinates[0][1][0].x, 0.0);  // has none
  EXPECT_EQ(scene.corners.coordinates[0][2][0].x, 0.75);
}

/// So do the triangles of the light that a scene without one gets, also when triangles are put in another
/// order: the second face lies on the first.
TEST_F(CornerAttributesTest, StayInStepWithTheDefaultLight) {
  write("m.obj", std::string(kTilted) +
                     "v 0.25 0.25 0\nv 0.5 0.25 0\nv 0.25 0.5 0\n"
                     "f 1//1 2//2 3//3\nf 5 6 7\nf 2//1 4//2 3//3\n");
  const Scene scene = testbench::load_scene(directory_ / "m.obj");
  ASSERT_EQ(scene.triangles.size(), 5u);
  ASSERT_EQ(scene.corners.normals.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) {
    const bool is_bent = scene.triangles[i].vertex[2] == glm::dvec3(0, 1, 0);
    EXPECT_EQ(scene.corners.normals[i][0] != glm::dvec3(0.0), is_bent) << i;
  }
}

TEST_F(CornerAttributesTest, ScenesMoveNormalsWithTheirMesh) {
  const Scene scene = load(std::string(kTilted) + "f 1//1 2//2 3//3\n",
                           "rotate_degrees = [0, 0, 90]\nscale = 7\ntranslate = [1, 2, 3]\n");
  ASSERT_EQ(scene.corners.normals.size(), 1u);
  expect_near(scene.corners.normals[0][0], {0, 0.6, 0.8});
  expect_near(scene.corners.normals[0][1], {-0.6, 0, 0.8});
}

TEST_F(CornerAttributesTest, BadIndicesAndNumbersAreNotedAndFlat) {
  const Scene scene = load(
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt x\nvt 0 0\nvn 0 nan 1\nvn 1 0 1\nf 1/9/1 2/1/2 3/1/2\nf 1/1/2 3/1/2 "
      "2/2/99999999999999999999\n");
  EXPECT_TRUE(scene.corners.normals.empty());
  ASSERT_EQ(scene.corners.coordinates[0].size(), 2u);
  EXPECT_EQ(scene.corners.coordinates[0][1][0], glm::dvec2(0.0, 1.0));
  std::string notes;
  for (const std::string& line : scene.notes.lines()) notes += line + "\n";
  EXPECT_NE(notes.find(":8: a normal that is no direction is left out\n"), std::string::npos) << notes;
  EXPECT_NE(notes.find(":6: a texture coordinate that is no number is 0\n"), std::string::npos) << notes;
  EXPECT_NE(notes.find(":10: an index of no texture coordinate or normal is left out, 2 times"),
            std::string::npos)
      << notes;
}

TEST_F(CornerAttributesTest, PlyHasNormalsAndCoordinatesForATexturedMaterial) {
  write("t.png", test_support::png_bytes(1, 1, {1, 2, 3}));
  write("m.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "property float nx\nproperty float ny\nproperty float nz\nproperty float s\nproperty float t\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0 0 3 4 0 0\n1 0 0 0 3 4 1 0.25\n0 1 0 0 3 4 0 1\n3 0 1 2\n");
  const auto load_with = [&](const std::string& texture) {
    return testbench::load_scene(write(
        "scene.toml", std::string(kCamera) + "[[mesh]]\nfile = \"m.ply\"\nmaterial = {emission = [1, 1, 1]" +
                          texture + "}\n"));
  };
  const Scene plain = load_with("");
  EXPECT_TRUE(plain.corners.coordinates[0].empty());
  expect_near(plain.corners.normals.at(0)[1], {0, 0.6, 0.8});
  const Scene textured = load_with(", reflectance_texture = \"t.png\"");
  EXPECT_EQ(textured.corners.coordinates[0].at(0)[1], glm::dvec2(1.0, 0.75));
  EXPECT_EQ(textured.materials.at(0).reflectance, glm::dvec3(1.0));
}

/// A sphere's normals stay normal to the ellipsoid that the node makes of it.
TEST_F(CornerAttributesTest, GltfNormalsMoveByTheInverseTranspose) {
  const Scene scene = load_gltf({1, 1, 1}, {{"scale", {2, 1, 0.5}}});
  expect_near(scene.corners.normals.at(0)[0], {0.5, 1, 2});
  const Scene mirrored = load_gltf({1, 1, 1}, {{"scale", {-2, 1, 0.5}}});
  expect_near(mirrored.corners.normals.at(0)[0], {-0.5, 1, 2});
  const testbench::Triangle& triangle = mirrored.triangles.at(0);
  const glm::dvec3 front =
      glm::cross(triangle.vertex[1] - triangle.vertex[0], triangle.vertex[2] - triangle.vertex[0]);
  EXPECT_GT(glm::dot(front, mirrored.corners.normals[0][0]), 0.0);
}

TEST_F(CornerAttributesTest, GltfNormalsTakePartInMorphing) {
  GltfBuilder file;
  const std::size_t positions = file.add_accessor("VEC3", 3, test_support::kGltfCorners);
  const std::vector<float> up{0, 0, 1, 0, 0, 1, 0, 0, 1};
  const std::vector<float> offset{2, 0, 0, 0, 0, 0, 0, 0, 0};
  const std::size_t normals = file.add_accessor<float>("VEC3", 3, up);
  const std::size_t offsets = file.add_accessor<float>("VEC3", 3, offset);
  file.add_mesh({{"POSITION", positions}, {"NORMAL", normals}}, {{"targets", {{{"NORMAL", offsets}}}}});
  file.root["meshes"][0]["weights"] = {0.5};
  file.add_node({{"mesh", 0}});
  write("a.bin", file.bytes);
  const testbench::Mesh mesh = testbench::load_gltf(write("a.gltf", file.root.dump()),
                                                    {testbench::FileReach(directory_), std::nullopt})
                                   .mesh;
  expect_near(mesh.corners.normals.at(0)[0], {1, 0, 1});
  expect_near(mesh.corners.normals[0][1], {0, 0, 1});
}

/// A mesh of one triangle with a normal texture, each of whose vertices has these tangents.
class GltfTangents : public CornerAttributesTest {
 protected:
  Scene load_tangents(const std::vector<float>& tangents, nlohmann::json node, bool has_normals = true,
                      bool is_light = false) {
    write("n.png", test_support::png_bytes(1, 1, {200, 128, 220}));
    GltfBuilder file;
    nlohmann::json attributes = {{"POSITION", file.add_accessor("VEC3", 3, test_support::kGltfCorners)}};
    if (has_normals)
      attributes["NORMAL"] =
          file.add_accessor<float>("VEC3", 3, std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1});
    attributes["TANGENT"] = file.add_accessor<float>("VEC4", 4, tangents);
    file.add_mesh(attributes, {{"material", 0}});
    file.add("images", {{"uri", "n.png"}});
    file.add("textures", {{"source", 0}});
    nlohmann::json material = {{"normalTexture", {{"index", 0}}}};
    if (is_light) material.update({{"emissiveFactor", {1, 1, 1}}, {"doubleSided", true}});
    file.add("materials", material);
    node["mesh"] = 0;
    file.add_node(node);
    write("a.bin", file.bytes);
    return testbench::load_scene(write("a.gltf", file.root.dump()));
  }
};

void expect_tangent(const glm::dvec4& found, const glm::dvec3& direction, double side) {
  expect_near(glm::dvec3(found), direction);
  EXPECT_EQ(found.w, side);
}

const std::vector<float> kTangents{3, 0, 4, -1, 0, 1, 0, -1, 1, 1, 0, -1};

/// Tangents move as directions do, unlike normals; a mirror changes their side.
TEST_F(GltfTangents, MoveWithTheirMeshAndKeepTheirSide) {
  const Scene still = load_tangents(kTangents, {});
  ASSERT_FALSE(still.corners.tangents.empty());
  expect_tangent(still.corners.tangents[0][0], {3, 0, 4}, -1.0);
  expect_tangent(still.corners.tangents[0][1], {0, 1, 0}, -1.0);
  expect_tangent(still.corners.tangents[0][2], {1, 1, 0}, -1.0);
  const Scene stretched = load_tangents(kTangents, {{"scale", {2, 1, 0.5}}});
  expect_tangent(stretched.corners.tangents.at(0)[0], {6, 0, 2}, -1.0);
  const Scene mirrored = load_tangents(kTangents, {{"scale", {-2, 1, 0.5}}});
  expect_tangent(mirrored.corners.tangents.at(0)[0], {-6, 0, 2}, 1.0);
}

/// glTF 2.0, section 3.7.2.1.
TEST_F(GltfTangents, AreIgnoredWithoutNormals) {
  const Scene scene = load_tangents(kTangents, {}, false);
  EXPECT_TRUE(scene.corners.tangents.empty());
  EXPECT_FALSE(scene.notes.lines().empty());
}

/// Where corners lie on different sides of the image, or have no tangent, the triangle has none.
TEST_F(GltfTangents, ThatDisagreeAreNone) {
  EXPECT_TRUE(load_tangents({1, 0, 0, 1, 1, 0, 0, -1, 1, 0, 0, 1}, {}).corners.tangents.empty());
  EXPECT_TRUE(load_tangents({1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 0, 1}, {}).corners.tangents.empty());
  EXPECT_TRUE(load_tangents({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, {}).corners.tangents.empty());
}

/// The sheet behind a light shows the image from its own front: mirrored, by the same tangents.
TEST_F(GltfTangents, OfBackSidesHaveTheOtherSide) {
  const Scene scene = load_tangents(kTangents, {}, true, true);
  ASSERT_EQ(scene.corners.tangents.size(), 2u);
  expect_tangent(scene.corners.tangents[1][0], {3, 0, 4}, 1.0);
  expect_tangent(scene.corners.tangents[1][2], {0, 1, 0}, 1.0);  // the second corner of the front
}

TEST_F(CornerAttributesTest, GltfWithoutNormalsIsFlat) {
  EXPECT_TRUE(load_gltf({0, 0, 1}, {}).corners.is_empty());
  EXPECT_TRUE(load_gltf({0, 0, 0}, {}).corners.is_empty());
}

/// A light that emits from both sides is two sheets; the one behind has the normals of its own front.
TEST_F(CornerAttributesTest, BackSidesHaveNormalsOfTheirFront) {
  GltfBuilder file;
  const std::size_t positions = file.add_accessor("VEC3", 3, test_support::kGltfCorners);
  const std::size_t normals =
      file.add_accessor<float>("VEC3", 3, std::vector<float>{0, 0, 1, 3, 0, 4, 0, 0, 1});
  file.add_mesh({{"POSITION", positions}, {"NORMAL", normals}}, {{"material", 0}});
  file.add("materials", {{"emissiveFactor", {1, 1, 1}}, {"doubleSided", true}});
  file.add_node({{"mesh", 0}});
  write("a.bin", file.bytes);
  const Scene scene = testbench::load_scene(write("a.gltf", file.root.dump()));
  ASSERT_EQ(scene.triangles.size(), 2u);
  ASSERT_EQ(scene.corners.normals.size(), 2u);
  expect_near(scene.corners.normals[0][1], {0.6, 0, 0.8});
  expect_near(scene.corners.normals[1][2], {-0.6, 0, -0.8});  // the second and third corner change places
}

}  // namespace corner_attributes_test
