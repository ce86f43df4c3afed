#include <gtest/gtest.h>

#include <chrono>
#include <string>

#include "testbench/scene/obj_mesh.hpp"
#include "testbench/system/error.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/temporary_directory.hpp"

namespace obj_mesh_test {

using testbench::load_obj_mesh;
using testbench::Mesh;

constexpr const char* kMaterials = "newmtl grey\nKd 0.5 0.5 0.5\nnewmtl lamp\nKd 0.25 0.5 1\nKe 4 5 6\n";
constexpr const char* kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

class ObjMeshTest : public test_support::DirectoryFixture {
 protected:
  ObjMeshTest() { write("m.mtl", kMaterials); }

  Mesh load(const std::string& obj) { return load_obj_mesh(write("mesh.obj", "mtllib m.mtl\n" + obj)); }

  void expect_error(const std::string& obj, const std::vector<std::string>& parts) {
    expect_error_of([&] { load(obj); }, parts);
  }
  void expect_material_error(const std::string& mtl, const std::vector<std::string>& parts) {
    write("m.mtl", mtl);
    expect_error(std::string(kSquare) + "usemtl grey\nf 1 2 3\n", parts);
  }
  template <class Call>
  void expect_error_of(Call call, std::vector<std::string> parts) {
    parts.emplace_back("allowed: ");
    test_support::expect_input_error(call, parts);
  }
};

TEST_F(ObjMeshTest, reads_numbers_to_the_last_bit) {
  write("m.mtl",
        "newmtl grey\nKd 0.1000000000000000055 0.73775306844182487 +1e-3\nKe 17.198711539995688 0 1E2\n");
  const Mesh mesh = load(
      "v 549.6000000001 0.1 -0.30000000000000004\nv 123456789.12345678 1e-300 .5\nv 4.35 "
      "2.2250738585072014e-308 "
      "1.7976931348623157e8\nusemtl grey\nf 1 2 3\n");
  ASSERT_EQ(mesh.triangles.size(), 1U);
  const auto& v = mesh.triangles[0].vertex;
  EXPECT_EQ(v[0], glm::dvec3(549.6000000001, 0.1, -0.30000000000000004));
  EXPECT_EQ(v[1], glm::dvec3(123456789.12345678, 1e-300, 0.5));
  EXPECT_EQ(v[2], glm::dvec3(4.35, 2.2250738585072014e-308, 1.7976931348623157e8));
  EXPECT_EQ(mesh.materials[0].reflectance, glm::dvec3(0.1, 0.73775306844182487, 1e-3));
  EXPECT_EQ(mesh.materials[0].emission, glm::dvec3(17.198711539995688, 0.0, 100.0));
}

TEST_F(ObjMeshTest, keeps_the_materials_in_use_only) {
  write("m.mtl", std::string("newmtl unused\nKd 1 1 1\n") + kMaterials);
  const Mesh mesh = load(std::string(kSquare) + "usemtl lamp\nf 1 2 3\nusemtl grey\nf 1 3 4\n");
  ASSERT_EQ(mesh.materials.size(), 2U);
  EXPECT_EQ(mesh.materials[0].name, "grey");
  EXPECT_EQ(mesh.materials[1].name, "lamp");
  EXPECT_EQ(mesh.materials[1].reflectance, glm::dvec3(0.25, 0.5, 1.0));
  EXPECT_EQ(mesh.materials[1].emission, glm::dvec3(4.0, 5.0, 6.0));
  ASSERT_EQ(mesh.triangles.size(), 2U);
  EXPECT_EQ(mesh.triangles[0].material, 1);
  EXPECT_EQ(mesh.triangles[1].material, 0);
}

TEST_F(ObjMeshTest, reads_crlf_comments_groups_and_relative_indices) {
  const Mesh mesh = load(
      "# a comment\r\no thing\r\nv 0 0 0\r\n  v 1 0 0\r\nv\t0 1 0 1.0\r\nusemtl grey\r\ng part\r\nf -3/1/1 "
      "-2// -1\r\nvt 0 "
      "0\r\nvn 0 0 1\r\n");
  ASSERT_EQ(mesh.triangles.size(), 1U);
  EXPECT_EQ(mesh.triangles[0].vertex[1], glm::dvec3(1, 0, 0));
  EXPECT_EQ(mesh.triangles[0].vertex[2], glm::dvec3(0, 1, 0));
}

// The shorter diagonal of this quad is 2-4, but the fan from the first vertex uses 1-3.
TEST_F(ObjMeshTest, cuts_convex_polygons_into_a_fan_from_the_first_vertex) {
  const Mesh quad = load("v 0 0 0\nv 2 -1 0\nv 4 0 0\nv 2 1 0\nusemtl grey\nf 1 2 3 4\n");
  ASSERT_EQ(quad.triangles.size(), 2U);
  EXPECT_EQ(quad.triangles[0].vertex[2], glm::dvec3(4, 0, 0));
  EXPECT_EQ(quad.triangles[1].vertex[1], glm::dvec3(4, 0, 0));
  EXPECT_EQ(quad.triangles[1].vertex[2], glm::dvec3(2, 1, 0));
  const Mesh pentagon = load("v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\nv 0 1 0\nusemtl grey\nf 1 2 3 4 5\n");
  ASSERT_EQ(pentagon.triangles.size(), 3U);
  for (const auto& t : pentagon.triangles) EXPECT_EQ(t.vertex[0], glm::dvec3(0));
}

// A dart, listed from each of its vertices: vertex 3 is concave, so only the diagonal 1-3 lies inside.
TEST_F(ObjMeshTest, cuts_concave_quads_along_the_inner_diagonal) {
  for (const char* face : {"f 1 2 3 4", "f 2 3 4 1", "f 3 4 1 2", "f 4 1 2 3"}) {
    const Mesh mesh = load(std::string("v 0 0 0\nv 3 1 0\nv 1 1 0\nv 1 3 0\nusemtl grey\n") + face + "\n");
    double area = 0.0;
    ASSERT_EQ(mesh.triangles.size(), 2U);
    for (const auto& t : mesh.triangles) {
      const double twice = glm::cross(t.vertex[1] - t.vertex[0], t.vertex[2] - t.vertex[0]).z;
      EXPECT_GT(twice, 0.0) << face;
      area += 0.5 * twice;
    }
    EXPECT_DOUBLE_EQ(area, 2.0);
  }
}

TEST_F(ObjMeshTest, refuses_a_polygon_no_fan_covers) {
  // A polygon with two dents in opposite directions (an S), and a quad that crosses itself.
  expect_error(
      "v 0 0 0\nv 3 0 0\nv 3 2 0\nv 1 2 0\nv 1 3 0\nv 3 3 0\nv 3 4 0\nv 0 4 0\nv 0 1.9 0\nv 2 1.9 0\nv 2 1 "
      "0\nv 0 1 "
      "0\no comb\nusemtl grey\nf 1 2 3 4 5 6 7 8 9 10 11 12\n",
      {"mesh.obj", "'comb'", "12 vertices"});
  expect_error("v 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 2 0\no bow\nusemtl grey\nf 1 2 3 4\n",
               {"'bow'", "4 vertices"});
}

TEST_F(ObjMeshTest, drops_and_counts_triangles_without_area) {
  const Mesh mesh = load(
      "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 0.1 0.1 0.1\nv 0.2 0.2 0.2\nv 0.3 0.3 0.3\nusemtl grey\nf 1 2 "
      "3\nf 1 1 4\nf "
      "5 6 7\nf 1 2 4\n");
  EXPECT_EQ(mesh.triangles.size(), 1U);
  EXPECT_EQ(mesh.degenerate_triangles, 3U);
}

TEST_F(ObjMeshTest, keeps_small_and_thin_triangles) {
  const Mesh mesh =
      load("v 0 0 0\nv 1e-30 0 0\nv 0 1e-30 0\nv 1 0 0\nv 0 1e-9 0\nusemtl grey\nf 1 2 3\nf 1 4 5\n");
  EXPECT_EQ(mesh.triangles.size(), 2U);
  EXPECT_EQ(mesh.degenerate_triangles, 0U);
}

TEST_F(ObjMeshTest, refuses_bad_vertices) {
  const std::string rest = "v 1 0 0\nv 0 1 0\nusemtl grey\nf 1 2 3\n";
  for (const std::string bad : {"nan 0 0", "0 inf 0", "0 0 -inf", "0 0", "a b c", "1e400 0 0", "1e101 0 0",
                                "1,5 0 0", "0x10 0 0", ""}) {
    SCOPED_TRACE(bad);
    expect_error("v " + bad + "\n" + rest, {"mesh.obj:2", "vertex 1", "found '" + bad + "'"});
  }
}

TEST_F(ObjMeshTest, refuses_bad_indices) {
  const std::string square = std::string("o box\n") + kSquare + "usemtl grey\n";
  expect_error(square + "f 1 2 5\n", {"mesh.obj", "'box'", "vertex index 5", "1 to 4"});
  expect_error(square + "f 1 2 2000000000\n", {"vertex index 2000000000"});
  expect_error(square + "f 1 2 0\n", {"mesh.obj", "line"});
  expect_error(square + "f 1 2 -9\n", {"mesh.obj"});
  expect_error(square + "f 1 2\n", {"mesh.obj"});
}

TEST_F(ObjMeshTest, refuses_missing_materials) {
  expect_error(std::string(kSquare) + "usemtl blue\nf 1 2 3\n", {"mesh.obj", "blue"});
  expect_error(std::string("o box\n") + kSquare + "f 1 2 3\n", {"mesh.obj", "'box'", "without a material"});
  expect_error_of([&] { load_obj_mesh(write("a.obj", "mtllib gone.mtl\nv 0 0 0\n")); },
                  {"gone.mtl", "a.obj"});
}

TEST_F(ObjMeshTest, refuses_bad_colours) {
  expect_material_error("newmtl grey\nKd 0.5 1.5 0.5\n",
                        {"m.mtl:2", "'grey'", "Kd", "0.5 1.5 0.5", "0 to 1"});
  expect_material_error("newmtl grey\nKd -0.1 0 0\n", {"'grey'", "-0.1"});
  expect_material_error("newmtl grey\nKd nan 0 0\n", {"'grey'", "nan"});
  expect_material_error("newmtl grey\nKd 0.5\n", {"'grey'", "'0.5'", "3 numbers"});
  expect_material_error("newmtl grey\nKd spectral file.rfl\n", {"'grey'", "spectral"});
  expect_material_error("newmtl grey\nKe 0 -1 0\n", {"'grey'", "Ke", "-1"});
  expect_material_error("newmtl grey\nKe inf 0 0\n", {"'grey'", "Ke", "inf"});
  expect_material_error("newmtl grey\nKe 0 0 1e13\n", {"'grey'", "Ke", "1e12"});
  expect_material_error("newmtl grey\nmap_Kd wood.png\n", {"'grey'", "map_Kd", "wood.png"});
  expect_material_error("newmtl grey\nnewmtl grey\n", {"m.mtl:2", "grey", "once"});
  expect_material_error("Kd 1 1 1\nnewmtl grey\n", {"m.mtl:1", "newmtl"});
  expect_material_error("# nothing\n", {"m.mtl", "newmtl"});
}

TEST_F(ObjMeshTest, refuses_unreadable_or_empty_files) {
  expect_error_of([&] { load_obj_mesh(directory_ / "none.obj"); }, {"none.obj", "cannot be read"});
  expect_error_of([&] { load_obj_mesh(directory_); }, {"cannot be read"});
  expect_error_of([&] { load_obj_mesh(write("empty.obj", "")); }, {"empty.obj", "no triangle"});
  expect_error_of([&] { load_obj_mesh(write("text.obj", "not a mesh at all\n")); },
                  {"text.obj", "no triangle"});
  expect_error("v 0 0 0\nv 1 0 0\nv 2 0 0\nusemtl grey\nf 1 2 3\n", {"no triangle", "1 without area"});
}

/// A grid of n x n quads over the unit square.
std::string grid(int n) {
  std::string obj;
  for (int y = 0; y <= n; ++y) {
    for (int x = 0; x <= n; ++x) {
      obj += "v " + std::to_string(static_cast<double>(x) / n) + " " +
             std::to_string(static_cast<double>(y) / n) + " 0\n";
    }
  }
  obj += "usemtl grey\n";
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      const int corner = y * (n + 1) + x + 1;
      for (const int index : {0, 1, n + 2, n + 1})
        obj += (index == 0 ? "f " : " ") + std::to_string(corner + index);
      obj += "\n";
    }
  }
  return obj;
}

double total_area(const Mesh& mesh) {
  double area = 0.0;
  for (const auto& t : mesh.triangles)
    area += 0.5 * glm::cross(t.vertex[1] - t.vertex[0], t.vertex[2] - t.vertex[0]).z;
  return area;
}

TEST_F(ObjMeshTest, loads_a_thousand_triangles) {
  const Mesh mesh = load(grid(25));
  EXPECT_EQ(mesh.triangles.size(), 1250U);
  EXPECT_NEAR(total_area(mesh), 1.0, 1e-12);
}

TEST_F(ObjMeshTest, loads_a_million_triangles_quickly) {
  const std::string obj = grid(708);
  const auto begin = std::chrono::steady_clock::now();
  const Mesh mesh = load(obj);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
  EXPECT_EQ(mesh.triangles.size() + mesh.degenerate_triangles, 2U * 708U * 708U);
  EXPECT_EQ(mesh.degenerate_triangles, 0U);
  EXPECT_NEAR(total_area(mesh), 1.0, 1e-9);
  RecordProperty("load_seconds", std::to_string(seconds.count()));
  EXPECT_LT(seconds.count(),
            60.0);  // takes about 1 s; quadratic behaviour would take hours
}

}  // namespace obj_mesh_test
