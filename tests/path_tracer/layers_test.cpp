// Surfaces that coincide: which of them a ray hits, at which distance, and that none shadows another.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "testbench/scene/coincident_triangles.hpp"
#include "tests/support/search_meshes.hpp"
#include "tests/support/test_rays.hpp"
#include "tests/support/tree_search.hpp"

namespace layers_test {

using path_tracer::LayeredTriangleRecord;
using path_tracer::RayRecord;
using test_support::RaySearch;
using test_support::SearchHit;
using test_support::SearchScene;
using testbench::Scene;
using testbench::Triangle;

constexpr path_tracer::TreeShape kShape{{path_tracer::NodeFormat::fp32, 4}, 1, 1, 2, 0, 0};

/// A rotation, a scale and a shift.
struct Placement {
  glm::dvec3 u, v, w;
  double scale;
  glm::dvec3 shift;

  glm::dvec3 operator()(const glm::dvec3& p) const { return (u * p.x + v * p.y + w * p.z) * scale + shift; }
};

Placement any_placement(std::mt19937_64& random, double scale, double shift) {
  std::normal_distribution<double> number;
  const auto any = [&] { return glm::normalize(glm::dvec3(number(random), number(random), number(random))); };
  const glm::dvec3 u = any();
  const glm::dvec3 v = glm::normalize(glm::cross(u, any()));
  return {u, v, glm::cross(u, v), scale, any() * shift};
}

/// Scales with shifts, for scales of 1e-30 to 1e30.
constexpr double kSizes[][2] = {{1, 0},    {1, 1e6},     {1, 1e7},    {1e-30, 0},
                                {1e30, 0}, {1e-6, 1e-2}, {1e12, 1e15}};

Scene placed(const std::vector<Triangle>& triangles, const Placement& place) {
  Scene scene;
  scene.name = "layers";
  scene.film = {4, 4};
  scene.materials = {{"wall", glm::dvec3(0.5), glm::dvec3(0.0)}, {"lamp", glm::dvec3(0.0), glm::dvec3(1.0)}};
  for (Triangle triangle : triangles) {
    for (glm::dvec3& vertex : triangle.vertex) vertex = place(vertex);
    scene.triangles.push_back(triangle);
  }
  scene.camera.position = place({0, 0, 5});
  testbench::order_coincident_triangles(scene, scene.name);
  return scene;
}

void add_square(std::vector<Triangle>& triangles, double half, double z, bool faces_up, int material) {
  const glm::dvec3 a(-half, -half, z), b(half, -half, z), c(half, half, z), d(-half, half, z);
  const std::size_t first = triangles.size();
  triangles.push_back({{a, b, c}, material});
  triangles.push_back({{a, c, d}, material});
  if (faces_up) return;
  for (std::size_t i = first; i < triangles.size(); ++i)
    std::swap(triangles[i].vertex[1], triangles[i].vertex[2]);
}

cn::vec3<double> as_record(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}

class Layers : public testing::Test {
 protected:
  /// Rays from above the plane z = 0, or below it, to points of the square of half the side.
  std::vector<RayRecord> rays_to(const Placement& place, double half, bool from_above) {
    std::vector<RayRecord> rays(RaySearch::kPes);
    std::uniform_real_distribution<double> number(-1, 1);
    for (RayRecord& ray : rays) {
      const glm::dvec3 from(4 * number(random_), 4 * number(random_),
                            (from_above ? 1 : -1) * (2 + number(random_)));
      const glm::dvec3 to(half * number(random_), half * number(random_), 0.0);
      ray.origin = as_record(place(from));
      ray.direction = as_record(place(to) - place(from));
    }
    return rays;
  }

  std::mt19937_64 random_{77};
  RaySearch search_{cn::widest_level()};
};

/// A lamp in a ceiling, both facing down, above a floor; and on the ceiling's other side a floor facing up.
TEST_F(Layers, WhatFacesTheRayIsSeenLightsFirst) {
  for (const auto& size : kSizes)
    for (int round = 0; round < 8; ++round) {
      const Placement place = any_placement(random_, size[0], size[1]);
      std::vector<Triangle> triangles;
      add_square(triangles, 2.0, 0.0, false, 0);
      add_square(triangles, 1.0, 0.0, false, 1);
      add_square(triangles, 3.0, 0.0, true, 0);
      const Scene scene = placed(triangles, place);
      ASSERT_EQ(scene.coincident_triangles, 6u);
      const SearchScene searched = test_support::search_scene(scene, kShape);
      ASSERT_TRUE(searched.layers.any);
      // By the order of the loader 0 and 1 are the lamp, 2 and 3 the ceiling, 4 and 5 the floor.
      for (const SearchHit& hit : search_.brute_force(searched, rays_to(place, 0.999, false))) {
        EXPECT_TRUE(hit.number == 0 || hit.number == 1) << hit.number;
        EXPECT_EQ(hit.record.front, 1);
      }
      for (const SearchHit& hit : search_.brute_force(searched, rays_to(place, 2.999, true))) {
        EXPECT_TRUE(hit.number == 4 || hit.number == 5) << hit.number;
        EXPECT_EQ(hit.record.front, 1);
      }
    }
}

/// A carpet changes no bit of where a ray hits the floor, nor does one that lies the other side up.
TEST_F(Layers, AreAllAtOneDistance) {
  for (const auto& size : kSizes)
    for (int round = 0; round < 4; ++round) {
      const Placement place = any_placement(random_, size[0], size[1]);
      std::vector<Triangle> triangles;
      add_square(triangles, 2.0, 0.0, true, 1);
      add_square(triangles, 1.0, 0.0, true, 1);
      add_square(triangles, 0.01, 0.0, true, 1);
      add_square(triangles, 0.5, 0.0, false, 1);
      const SearchScene searched = test_support::search_scene(placed(triangles, place), kShape);
      ASSERT_TRUE(searched.layers.any);
      const std::vector<RayRecord> rays = rays_to(place, 0.00999, round % 2 == 0);
      std::vector<std::vector<SearchHit>> of_pair;
      for (int pair = 0; pair < 4; ++pair) {
        SearchScene alone = searched;
        const int bytes = searched.layers.record_bytes();
        alone.triangle_count = 2;
        alone.triangles.assign(searched.triangles.begin() + 2 * pair * bytes,
                               searched.triangles.begin() + 2 * (pair + 1) * bytes);
        of_pair.push_back(search_.brute_force(alone, rays));
      }
      for (std::size_t i = 0; i < rays.size(); ++i)
        for (std::size_t pair = 0; pair < 4; ++pair) {
          ASSERT_EQ(of_pair[pair][i].record.hit, 1);
          EXPECT_EQ(std::memcmp(&of_pair[pair][i].record.position, &of_pair[0][i].record.position,
                                sizeof(cn::vec3<double>)),
                    0);
          EXPECT_EQ(of_pair[pair][i].record.front == of_pair[0][i].record.front, pair != 3);
        }
    }
}

/// A ray that leaves one of the layers meets none of the others.
TEST_F(Layers, DoNotShadowEachOther) {
  for (const auto& size : kSizes) {
    const Placement place = any_placement(random_, size[0], size[1]);
    std::vector<Triangle> triangles;
    add_square(triangles, 2.0, 0.0, true, 1);
    add_square(triangles, 1.0, 0.0, true, 0);
    add_square(triangles, 1.0, 0.0, false, 0);
    std::uniform_real_distribution<double> number(-1, 1);
    for (int i = 0; i < 30; ++i) {
      const auto corner = [&] { return glm::dvec3(2 * number(random_), 2 * number(random_), 0); };
      triangles.push_back({{corner(), corner(), corner()}, 0});
    }
    const Scene scene = placed(triangles, place);
    const SearchScene searched = test_support::search_scene(scene, kShape);
    test_support::TestRays source(scene, 3);
    for (int batch = 0; batch < 20; ++batch) {
      std::vector<RayRecord> rays;
      for (int i = 0; i < RaySearch::kPes; ++i) {
        rays.push_back(source.ray(6));
        EXPECT_EQ(rays.back().left_face, source.face(0)) << "one face";
        const glm::dvec3 away(number(random_), number(random_), number(random_));
        rays.back().direction = as_record(place(away) - place(glm::dvec3(0.0)));
      }
      for (const SearchHit& hit : search_.brute_force(searched, rays)) EXPECT_EQ(hit.number, -1);
    }
  }
}

/// What the firmware relies on: planes that are equal up to a power of two and the sign.
TEST_F(Layers, ShareTheirPlaneToTheLastBit) {
  for (const auto& size : kSizes) {
    const Placement place = any_placement(random_, size[0], size[1]);
    std::vector<Triangle> triangles;
    add_square(triangles, 2.0, 0.0, true, 1);
    add_square(triangles, 0.125, 0.0, false, 0);
    add_square(triangles, 1e-3, 0.0, true, 0);
    const SearchScene searched = test_support::search_scene(placed(triangles, place), kShape);
    ASSERT_EQ(searched.layers.record_bytes(), int{sizeof(LayeredTriangleRecord)});
    const auto record = [&](int i) {
      return layered(path_tracer::triangle_at(searched.records(), i, searched.layers.record_bytes()));
    };
    const auto component = [](const LayeredTriangleRecord& of, int i) {
      const cn::vec3<double>& back = of.triangle.back;
      return i == 0 ? back.x : i == 1 ? back.y : i == 2 ? back.z : of.plane_offset;
    };
    const LayeredTriangleRecord first = record(0);
    for (int i = 1; i < searched.triangle_count; ++i) {
      const LayeredTriangleRecord other = record(i);
      const double ratio = other.triangle.back.x / first.triangle.back.x;
      EXPECT_EQ(std::abs(ratio), std::exp2(std::round(std::log2(std::abs(ratio)))));
      for (int k = 0; k < 4; ++k) EXPECT_EQ(component(other, k), component(first, k) * ratio);
      EXPECT_GE(other.area_ratio, 1.0);
      EXPECT_LE(other.area_ratio, 2.0);
      const Triangle& source = triangles[std::size_t(i)];
      const bool is_turned =
          glm::cross(source.vertex[1] - source.vertex[0], source.vertex[2] - source.vertex[0]).z < 0;
      EXPECT_EQ(ratio < 0, is_turned) << i;
    }
  }
}

TEST_F(Layers, ASceneWithoutThemHasShortRecords) {
  std::vector<Triangle> triangles;
  add_square(triangles, 2.0, 0.0, true, 1);
  add_square(triangles, 1.0, 1e-9, true, 0);
  std::mt19937_64 random(5);
  const SearchScene searched =
      test_support::search_scene(placed(triangles, any_placement(random, 1.0, 0.0)), kShape);
  EXPECT_FALSE(searched.layers.any);
  EXPECT_EQ(searched.layers.record_bytes(), int{sizeof(path_tracer::TriangleRecord)});
}

}  // namespace layers_test
