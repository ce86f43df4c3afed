#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <string>

#include "testbench/scene/obj_mesh.hpp"
#include "tests/scene/mesh_area.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/temporary_directory.hpp"

namespace obj_polygon_test {

using test_support::area;
using test_support::total_area;
using testbench::Mesh;

/// Faces with the material grey.
class ObjPolygonTest : public test_support::DirectoryFixture {
 protected:
  ObjPolygonTest() { write("m.mtl", "newmtl grey\nKd 0.5 0.5 0.5\n"); }
  Mesh load(const std::string& obj) {
    return testbench::load_obj_mesh(write("mesh.obj", "mtllib m.mtl\n" + obj));
  }
};

// The shorter diagonal of this quad is 2-4, but the fan from the first vertex uses 1-3.
TEST_F(ObjPolygonTest, cuts_convex_polygons_into_a_fan_from_the_first_vertex) {
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
TEST_F(ObjPolygonTest, cuts_concave_quads_along_the_inner_diagonal) {
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

/// A star: every `step`-th of `count` points on a circle.
std::string star(int count, int step) {
  std::ostringstream obj;
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * std::acos(-1.0) * step * i / count;
    obj << "v " << std::cos(angle) << " " << std::sin(angle) << " 0\n";
  }
  obj << "usemtl grey\nf";
  for (int i = 0; i < count; ++i) obj << " " << i + 1;
  obj << "\n";
  return obj.str();
}

// Each edge of a star crosses 2 (step - 1) others, and each crossing becomes a vertex.
TEST_F(ObjPolygonTest, refuses_a_polygon_whose_crossings_are_far_more_than_its_vertices) {
  EXPECT_GT(load(star(1001, 8)).triangles.size(), 7000U);
  test_support::expect_input_error(
      [&] { load(star(1001, 400)); },
      {"mesh.obj:1004", "a polygon of 1001 vertices that crosses itself too often"});
}

TEST_F(ObjPolygonTest, takes_a_comb_of_many_long_teeth) {
  std::ostringstream obj;
  constexpr int kTeeth = 2000;
  for (int i = 0; i < kTeeth; ++i) obj << "v " << 3 * i << " 0 0\nv " << 3 * i + 1 << " 9000 0\n";
  obj << "v " << 3 * kTeeth << " -1 0\nv 0 -1 0\nusemtl grey\nf";
  for (int i = 0; i < 2 * kTeeth + 2; ++i) obj << " " << i + 1;
  EXPECT_EQ(load(obj.str() + "\n").triangles.size(), std::size_t{2 * kTeeth});
}

// A polygon with two dents in opposite directions (an S), seen from each of its vertices.
TEST_F(ObjPolygonTest, triangulates_a_polygon_no_fan_covers) {
  const std::string vertices =
      "v 0 0 0\nv 3 0 0\nv 3 2 0\nv 1 2 0\nv 1 3 0\nv 3 3 0\nv 3 4 0\nv 0 4 0\nv 0 1.9 0\nv 2 1.9 0\nv 2 1 "
      "0\nv 0 1 0\nusemtl grey\nf";
  for (int start = 0; start < 12; ++start) {
    std::string face = vertices;
    for (int i = 0; i < 12; ++i) face += " " + std::to_string((start + i) % 12 + 1);
    const Mesh mesh = load(face + "\n");
    EXPECT_EQ(mesh.triangles.size(), 10U);
    for (const auto& t : mesh.triangles) EXPECT_GT(area(t).z, 0.0);
    EXPECT_NEAR(total_area(mesh), 8.2, 1e-12);
    EXPECT_TRUE(mesh.notes.lines().empty());
  }
}

// The same comb in planes of any direction, also at the ends of the range of coordinates.
TEST_F(ObjPolygonTest, triangulates_concave_polygons_in_any_plane_and_scale) {
  const glm::dvec2 comb[] = {{0, 0}, {7, 0}, {7, 5}, {5, 5}, {5, 1}, {4, 1},
                             {4, 5}, {3, 5}, {3, 1}, {1, 1}, {1, 5}, {0, 5}};
  for (const glm::dvec3& u : {glm::dvec3(1, 0, 0), glm::dvec3(0, -2, 0.5), glm::dvec3(0.3, 0.1, 9)}) {
    for (const double scale : {1.0, 1e-90, 1e90}) {
      const glm::dvec3 v = glm::cross(glm::dvec3(0.2, 3, 1), u);
      std::ostringstream obj;
      obj.precision(17);
      for (const glm::dvec2& p : comb) {
        const glm::dvec3 q = scale * (p.x * u + p.y * v);
        obj << "v " << q.x << " " << q.y << " " << q.z << "\n";
      }
      obj << "usemtl grey\nf 1 2 3 4 5 6 7 8 9 10 11 12\n";
      const Mesh mesh = load(obj.str());
      EXPECT_EQ(mesh.triangles.size() + mesh.degenerate_triangles, 10U);  // its notches end in one line
      double sum = 0.0;
      for (const auto& t : mesh.triangles) {
        const glm::dvec3 scaled = area({{t.vertex[0] / scale, t.vertex[1] / scale, t.vertex[2] / scale}, 0});
        EXPECT_GT(glm::dot(scaled, glm::cross(u, v)), 0.0);
        sum += glm::length(scaled);
      }
      EXPECT_NEAR(sum, 23.0 * glm::length(glm::cross(u, v)), 1e-9);
    }
  }
}

TEST_F(ObjPolygonTest, fills_a_polygon_that_crosses_itself_and_says_so) {
  const Mesh mesh = load("v 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 2 0\nusemtl grey\nf 1 2 3 4\n");
  ASSERT_EQ(mesh.triangles.size(), 2U);
  EXPECT_NEAR(glm::length(area(mesh.triangles[0])) + glm::length(area(mesh.triangles[1])), 2.0, 1e-12);
  EXPECT_EQ(
      mesh.notes.lines(),
      std::vector<std::string>{directory_.string() + "/mesh.obj:7: a polygon that crosses itself is filled"});
}

TEST_F(ObjPolygonTest, counts_the_corners_of_long_faces) {
  constexpr double kPi = 3.14159265358979323846;
  for (const int corners : {255, 256, 300, 65536, 70001}) {
    std::string disc;
    for (int i = 0; i < corners; ++i)
      disc += "v " + std::to_string(std::cos(2 * kPi * i / corners) * 1e9) + " " +
              std::to_string(std::sin(2 * kPi * i / corners) * 1e9) + " 0\n";
    disc += "usemtl grey\nf";
    for (int i = 1; i <= corners; ++i) disc += " " + std::to_string(i);
    const Mesh mesh = load(disc + "\nf 1 2 3\n");
    EXPECT_EQ(mesh.triangles.size() + mesh.degenerate_triangles, std::size_t(corners - 2 + 1));
    EXPECT_NEAR(total_area(mesh) / (kPi * 1e18), 1.0, 1e-3) << corners;
  }
}

// A star of 4,000 corners, of which no vertex sees all: longer than what fans are tried for.
TEST_F(ObjPolygonTest, triangulates_long_concave_faces) {
  constexpr int kTeeth = 2000;
  std::string saw;
  std::string face = "f";
  for (int i = 0; i < kTeeth; ++i)
    saw += "v " + std::to_string(i) + " 0 0\nv " + std::to_string(i) + ".5 3 0\n";
  saw += "v " + std::to_string(kTeeth) + " -1 0\nv 0 -1 0\nusemtl grey\n";
  for (int i = 2 * kTeeth + 2; i >= 1; --i) face += " " + std::to_string(i);
  const Mesh mesh = load(saw + face + "\n");
  EXPECT_EQ(mesh.triangles.size(), std::size_t(2 * kTeeth));
  double outline = 0.0;  // its area by the shoelace formula
  const auto corner = [](int i) {
    return i == 2 * kTeeth       ? glm::dvec2(kTeeth, -1)
           : i == 2 * kTeeth + 1 ? glm::dvec2(0, -1)
                                 : glm::dvec2(0.5 * i, i % 2 == 0 ? 0 : 3);
  };
  for (int i = 0; i < 2 * kTeeth + 2; ++i) {
    const glm::dvec2 a = corner(i);
    const glm::dvec2 b = corner((i + 1) % (2 * kTeeth + 2));
    outline -= 0.5 * (a.x * b.y - a.y * b.x);
  }
  EXPECT_NEAR(total_area(mesh), outline, 1e-9 * outline);
}

}  // namespace obj_polygon_test
