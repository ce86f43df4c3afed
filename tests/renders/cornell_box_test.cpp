// Tests the data of scenes/cornell_box: a watertight, consistently wound box without overlaps.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "testbench/scene_file/scene_file.hpp"

namespace cornell_box_test {

using testbench::Scene;
using testbench::Triangle;
using Point = std::tuple<double, double, double>;
using Edge = std::pair<Point, Point>;

Scene cornell_box() {
  return testbench::load_scene(std::string(CSX600_SCENES_DIR) + "/cornell_box");
}

Point point(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}

glm::dvec3 normal(const Triangle& t) {
  return glm::normalize(glm::cross(t.vertex[1] - t.vertex[0], t.vertex[2] - t.vertex[0]));
}

double area(const Triangle& t) {
  return 0.5 * glm::length(glm::cross(t.vertex[1] - t.vertex[0], t.vertex[2] - t.vertex[0]));
}

glm::dvec3 centre(const Triangle& t) {
  return (t.vertex[0] + t.vertex[1] + t.vertex[2]) / 3.0;
}

bool is_light(const Scene& scene, const Triangle& t) {
  return scene.materials[static_cast<std::size_t>(t.material)].emission != glm::dvec3(0.0);
}

std::map<Edge, int> directed_edges(const std::vector<Triangle>& triangles) {
  std::map<Edge, int> edges;
  for (const Triangle& t : triangles) {
    for (int i = 0; i < 3; ++i) ++edges[{point(t.vertex[i]), point(t.vertex[(i + 1) % 3])}];
  }
  return edges;
}

TEST(CornellBox, has_the_measured_counts_and_materials) {
  const Scene scene = cornell_box();
  EXPECT_EQ(scene.name, "cornell_box");
  EXPECT_EQ(scene.triangles.size(), 38U);
  EXPECT_EQ(scene.degenerate_triangles, 0U);
  EXPECT_EQ(scene.film.width, 480);
  EXPECT_EQ(scene.film.height, 480);
  std::vector<std::string> names;
  for (const auto& material : scene.materials) names.push_back(material.name);
  EXPECT_EQ(names, (std::vector<std::string>{"white", "green", "red", "light"}));
}

TEST(CornellBox, camera_puts_the_red_wall_on_the_left) {
  const Scene scene = cornell_box();
  EXPECT_EQ(scene.camera.position, glm::dvec3(278, 273, -800));
  EXPECT_NEAR(scene.camera.vertical_field_of_view_radians, 2.0 * std::atan(0.0125 / 0.035), 1e-15);
  const glm::dvec3 right = glm::cross(scene.camera.direction, scene.camera.up);
  for (const Triangle& t : scene.triangles) {
    const std::string& name = scene.materials[static_cast<std::size_t>(t.material)].name;
    const double side = glm::dot(centre(t) - scene.camera.position, right);
    if (name == "red") {
      EXPECT_LT(side, -200.0);
    } else if (name == "green") {
      EXPECT_GT(side, 200.0);
    }
  }
}

// Two triangles share every edge, in opposite directions, except around the open front (z = 0) and the
// blocks' feet.
TEST(CornellBox, is_closed_apart_from_the_front_and_the_feet_of_the_blocks) {
  const std::map<Edge, int> edges = directed_edges(cornell_box().triangles);
  int front_edges = 0;
  int foot_edges = 0;
  for (const auto& [edge, count] : edges) {
    ASSERT_EQ(count, 1) << "two triangles run the same way along an edge";
    if (edges.count({edge.second, edge.first}) == 1) continue;
    const auto& [ax, ay, az] = edge.first;
    const auto& [bx, by, bz] = edge.second;
    if (az == 0.0 && bz == 0.0) {
      ++front_edges;
    } else {
      EXPECT_TRUE(ay == 0.0 && by == 0.0) << "a hole at (" << ax << " " << ay << " " << az << ")";
      ++foot_edges;
    }
  }
  EXPECT_EQ(front_edges, 4);
  EXPECT_EQ(foot_edges, 8);
}

// No vertex lies inside an edge of another triangle. (The blocks' feet lie inside the floor, not on its
// edges.)
TEST(CornellBox, has_no_t_junctions) {
  const Scene scene = cornell_box();
  std::set<Point> points;
  for (const Triangle& t : scene.triangles) {
    for (const glm::dvec3& v : t.vertex) points.insert(point(v));
  }
  EXPECT_EQ(points.size(), 28U);
  for (const auto& [edge, count] : directed_edges(scene.triangles)) {
    const glm::dvec3 a(std::get<0>(edge.first), std::get<1>(edge.first), std::get<2>(edge.first));
    const glm::dvec3 b(std::get<0>(edge.second), std::get<1>(edge.second), std::get<2>(edge.second));
    for (const Point& p : points) {
      const glm::dvec3 v(std::get<0>(p), std::get<1>(p), std::get<2>(p));
      const double along = glm::dot(v - a, b - a) / glm::dot(b - a, b - a);
      if (along <= 1e-9 || along >= 1.0 - 1e-9) continue;
      EXPECT_GT(glm::length(v - a - along * (b - a)), 1e-6)
          << "at (" << v.x << " " << v.y << " " << v.z << ")";
    }
  }
}

// Moller-Trumbore without culling: the distance along the ray, or a negative number for a miss.
double hit_distance(const Triangle& t, const glm::dvec3& origin, const glm::dvec3& direction) {
  const glm::dvec3 e1 = t.vertex[1] - t.vertex[0];
  const glm::dvec3 e2 = t.vertex[2] - t.vertex[0];
  const glm::dvec3 p = glm::cross(direction, e2);
  const double determinant = glm::dot(e1, p);
  if (determinant == 0.0) return -1.0;
  const glm::dvec3 s = origin - t.vertex[0];
  const double u = glm::dot(s, p) / determinant;
  const glm::dvec3 q = glm::cross(s, e1);
  const double v = glm::dot(direction, q) / determinant;
  if (u < 0.0 || v < 0.0 || u + v > 1.0) return -1.0;
  return glm::dot(e2, q) / determinant;
}

// From unoccupied points of the box, a ray in any direction first meets a front face.
TEST(CornellBox, shows_only_front_faces_to_its_inside) {
  const Scene scene = cornell_box();
  int hits = 0;
  for (const glm::dvec3& origin : {glm::dvec3(278, 400, 280), glm::dvec3(40, 30, 40),
                                   glm::dvec3(510, 60, 500), glm::dvec3(250, 100, 350)}) {
    for (int i = 0; i < 2000; ++i) {  // a spiral of directions, uniform over the sphere
      const double z = 1.0 - (2.0 * i + 1.0) / 2000.0;
      const double angle = 2.399963229728653 * i;
      const glm::dvec3 direction(std::sqrt(1.0 - z * z) * std::cos(angle),
                                 std::sqrt(1.0 - z * z) * std::sin(angle), z);
      const Triangle* nearest = nullptr;
      double nearest_distance = 1e30;
      for (const Triangle& t : scene.triangles) {
        const double distance = hit_distance(t, origin, direction);
        if (distance > 0.0 && distance < nearest_distance) {
          nearest_distance = distance;
          nearest = &t;
        }
      }
      if (nearest == nullptr) continue;  // the ray leaves through the open front
      ++hits;
      ASSERT_LT(glm::dot(normal(*nearest), direction), 0.0);
    }
  }
  EXPECT_GT(hits, 6000);
}

TEST(CornellBox, light_faces_down_and_fills_the_hole_of_the_ceiling) {
  const Scene scene = cornell_box();
  std::vector<Triangle> light;
  std::vector<Triangle> ceiling;
  double light_area = 0.0;
  double ceiling_area = 0.0;
  for (const Triangle& t : scene.triangles) {
    const bool at_top = t.vertex[0].y == 548.8 && t.vertex[1].y == 548.8 && t.vertex[2].y == 548.8;
    if (is_light(scene, t)) {
      EXPECT_TRUE(at_top);
      light.push_back(t);
      light_area += area(t);
    } else if (at_top) {
      ceiling.push_back(t);
      ceiling_area += area(t);
    }
    if (at_top) {
      EXPECT_EQ(normal(t), glm::dvec3(0, -1, 0));
    }
  }
  EXPECT_EQ(light.size(), 2U);
  EXPECT_EQ(ceiling.size(), 8U);
  EXPECT_NEAR(light_area, 130.0 * 105.0, 1e-9);
  EXPECT_NEAR(light_area + ceiling_area, 556.0 * 559.2,
              1e-6);  // no gap and, since edges are shared, no overlap

  const std::map<Edge, int> light_edges = directed_edges(light);
  const std::map<Edge, int> ceiling_edges = directed_edges(ceiling);
  int shared = 0;
  for (const auto& [edge, count] : light_edges)
    shared += static_cast<int>(ceiling_edges.count({edge.second, edge.first}));
  EXPECT_EQ(shared, 4);
}

/// Whether the interiors of two coplanar triangles overlap: no edge of either separates them (separating axes
/// in the plane).
bool overlap_in_plane(const Triangle& a, const Triangle& b) {
  for (const auto& [from, to] : {std::pair(&a, &b), std::pair(&b, &a)}) {
    for (int i = 0; i < 3; ++i) {
      const glm::dvec3 edge = from->vertex[(i + 1) % 3] - from->vertex[i];
      const glm::dvec3 inward = glm::normalize(glm::cross(normal(*from), edge));
      bool all_outside = true;
      for (const glm::dvec3& v : to->vertex) all_outside &= glm::dot(v - from->vertex[i], inward) < 1e-9;
      if (all_outside) return false;
    }
  }
  return true;
}

TEST(CornellBox, has_no_coplanar_overlaps) {
  const Scene scene = cornell_box();
  int coplanar_pairs = 0;
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    for (std::size_t j = i + 1; j < scene.triangles.size(); ++j) {
      const Triangle& a = scene.triangles[i];
      const Triangle& b = scene.triangles[j];
      const glm::dvec3 n = normal(a);
      const bool coplanar = std::all_of(std::begin(b.vertex), std::end(b.vertex), [&](const glm::dvec3& v) {
        return std::abs(glm::dot(v - a.vertex[0], n)) < 1e-6;
      });
      if (!coplanar) continue;
      ++coplanar_pairs;
      EXPECT_FALSE(overlap_in_plane(a, b)) << i << " and " << j;
    }
  }
  EXPECT_GE(coplanar_pairs,
            45 + 1 + 1 + 1 + 10);  // the ceiling with its light, floor, back, right wall, block faces
}

TEST(CornellBox, overlap_check_finds_an_overlap) {
  const Triangle a{{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}, 0};
  const Triangle inside{{{0.1, 0.1, 0}, {0.5, 0.1, 0}, {0.1, 0.5, 0}}, 0};
  const Triangle beside{{{2, 0, 0}, {2, 2, 0}, {0, 2, 0}}, 0};
  EXPECT_TRUE(overlap_in_plane(a, inside));
  EXPECT_FALSE(overlap_in_plane(a, beside));
}

}  // namespace cornell_box_test
