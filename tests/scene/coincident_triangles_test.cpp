// Which triangles lie on one another, against a comparison of every pair, and how fast they are found.

#include "testbench/scene/coincident_triangles.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "testbench/scene/triangle_overlap.hpp"

namespace coincident_triangles_test {

using testbench::CoincidentTriangles;
using testbench::find_coincident_triangles;
using testbench::kNoGroup;
using testbench::Scene;
using testbench::Triangle;

/// A placement of a flat drawing in space.
struct Placement {
  double scale = 1;
  double shift = 0;
  bool is_tilted = true;

  glm::dvec3 operator()(double x, double y, double z = 0) const {
    const glm::dvec3 u = is_tilted ? glm::normalize(glm::dvec3(3, -1, 2)) : glm::dvec3(1, 0, 0);
    const glm::dvec3 v =
        is_tilted ? glm::normalize(glm::cross(u, glm::dvec3(0.1, 1, 0.3))) : glm::dvec3(0, 1, 0);
    return (u * x + v * y + glm::cross(u, v) * z) * scale + glm::dvec3(1, -0.6, 0.3) * shift;
  }
  Triangle triangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) const {
    return {{(*this)(a.x, a.y, a.z), (*this)(b.x, b.y, b.z), (*this)(c.x, c.y, c.z)}, 0};
  }
};

const Placement kPlacements[] = {{1, 0, false}, {1, 0},   {1e-30, 0},   {1e30, 0},
                                 {1, 1e6},      {1, 1e7}, {1e-6, 1e-2}, {1, 1e6, false}};

/// The numbers of the sets that are connected by coincide(), found pair by pair. Those that are too thin to
/// be told are left out.
std::vector<std::int32_t> by_pairs(const std::vector<Triangle>& triangles) {
  const testbench::SceneSize size = size_of(triangles, 0.0);
  std::vector<std::size_t> set(triangles.size());
  std::iota(set.begin(), set.end(), std::size_t{0});
  for (std::size_t i = 0; i < triangles.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (set[i] != set[j] && height_of(triangles[i]) >= size.least_height() &&
          height_of(triangles[j]) >= size.least_height() && coincide(triangles[i], triangles[j], size)) {
        const std::size_t from = std::max(set[i], set[j]);
        const std::size_t to = std::min(set[i], set[j]);
        std::replace(set.begin(), set.end(), from, to);
      }
  std::vector<std::int32_t> group(triangles.size(), kNoGroup);
  std::int32_t groups = 0;
  for (std::size_t i = 0; i < set.size(); ++i) {
    if (std::count(set.begin(), set.end(), set[i]) == 1) continue;
    group[i] = set[i] == i ? groups++ : group[set[i]];
  }
  return group;
}

/// Triangles of any size in some parallel planes: a few lie on others, most do not.
std::vector<Triangle> sheets(const Placement& place, int count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  std::vector<Triangle> triangles;
  while (int(triangles.size()) < count) {
    const double size = std::exp(-4 + 3 * number(random));
    const glm::dvec3 at(number(random), number(random), 0.125 * double(random() % 3));
    const auto corner = [&] { return at + glm::dvec3(number(random), number(random), 0.0) * size; };
    triangles.push_back(place.triangle(corner(), corner(), corner()));
    if (random() % 8 == 0) {  // one that shares an edge, or all of them
      Triangle other = triangles.back();
      if (random() % 2 == 0) other.vertex[0] = place(at.x, at.y, at.z);
      std::rotate(other.vertex, other.vertex + random() % 3, other.vertex + 3);
      if (random() % 2 == 0) std::swap(other.vertex[0], other.vertex[1]);
      triangles.push_back(other);
    }
  }
  return triangles;
}

TEST(CoincidentTriangles, AreThoseThatAComparisonOfAllPairsFinds) {
  for (const Placement& place : kPlacements)
    for (unsigned seed = 1; seed <= 4; ++seed) {
      const std::vector<Triangle> triangles = sheets(place, 250, seed);
      const CoincidentTriangles found = find_coincident_triangles(triangles);
      EXPECT_EQ(found.group, by_pairs(triangles)) << place.scale << " " << place.shift << " " << seed;
      EXPECT_GT(found.groups, 5);
      const auto alone = std::size_t(std::count(found.group.begin(), found.group.end(), kNoGroup));
      EXPECT_GT(alone, 5u);
      EXPECT_EQ(found.triangles, triangles.size() - alone);
    }
}

TEST(CoincidentTriangles, AreFoundHoweverTheyOverlap) {
  const glm::dvec3 a(0, 0, 0), b(4, 0, 0), c(4, 4, 0), d(0, 4, 0);
  for (const Placement& place : kPlacements) {
    const auto count = [&](std::initializer_list<Triangle> triangles) {
      return find_coincident_triangles(triangles).triangles;
    };
    const Triangle half = place.triangle(a, b, c);
    EXPECT_EQ(count({half, place.triangle(a, b, c)}), 2u) << "the same";
    EXPECT_EQ(count({half, place.triangle(c, b, a)}), 2u) << "back to back";
    EXPECT_EQ(count({half, place.triangle(a, b, d)}), 2u) << "on one side of a common edge";
    EXPECT_EQ(count({half, place.triangle({2, 1, 0}, {3, 1, 0}, {3, 2, 0})}), 2u) << "within";
    EXPECT_EQ(count({place.triangle({3.99, 0.01, 0}, {3.98, 0.01, 0}, {3.99, 0.02, 0}), half}), 2u)
        << "a small one";
    EXPECT_EQ(count({half, place.triangle({1, -1, 0}, {3, -1, 0}, {2, 5, 0})}), 2u) << "across";
  }
}

/// Neighbours that only touch are no layers, whatever their coordinates were rounded to.
TEST(CoincidentTriangles, AreNotNeighboursAndNotParallels) {
  const glm::dvec3 a(0, 0, 0), b(1, 0, 0), c(1, 1, 0), d(0, 1, 0);
  for (const Placement& place : kPlacements) {
    const auto none = [&](std::initializer_list<Triangle> triangles) {
      return find_coincident_triangles(triangles).triangles == 0;
    };
    const Triangle half = place.triangle(a, b, c);
    EXPECT_TRUE(none({half, place.triangle(a, c, d)})) << "a common edge";
    EXPECT_TRUE(none({half, place.triangle({0.2, 0, 0}, {0.7, 0, 0}, {0.3, -1, 0})})) << "part of an edge";
    EXPECT_TRUE(none({half, place.triangle({0.3, 0.3, 0}, {0.7, 0.7, 0}, {0, 1, 0})}))
        << "part of a diagonal";
    EXPECT_TRUE(none({half, place.triangle(c, {2, 1, 0}, {2, 2, 0})})) << "a common corner";
    EXPECT_TRUE(none({half, place.triangle({0, 0, 1}, {1, 0, 1}, {1, 1, 1})})) << "another plane";
    EXPECT_TRUE(none({half, place.triangle({0, 0, 0}, {1, 0, 0.001}, {1, 1, 0})})) << "a fold";
    std::vector<Triangle> strip;
    for (int i = 0; i < 200; ++i) {
      const double x = i / 7.0, next = (i + 1) / 7.0;
      strip.push_back(place.triangle({x, 0, 0}, {next, 0, 0}, {next, 1 / 3.0, 0}));
      strip.push_back(place.triangle({x, 0, 0}, {next, 1 / 3.0, 0}, {x, 1 / 3.0, 0}));
    }
    EXPECT_EQ(find_coincident_triangles(strip).triangles, 0u) << "a strip";
  }
}

/// Every pair would take 10^12 steps, or with two floors under the carpets 10^10.
TEST(CoincidentTriangles, AreFoundWithoutAComparisonOfAllPairs) {
  const Placement place;
  const Triangle one = place.triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  EXPECT_EQ(find_coincident_triangles(std::vector<Triangle>(1000000, one)).triangles, 1000000u);

  std::vector<Triangle> carpets{place.triangle({0, 0, 0}, {400, 0, 0}, {400, 400, 0}),
                                place.triangle({0, 0, 0}, {400, 400, 0}, {0, 400, 0})};
  for (int i = 0; i < 100000; ++i) {
    const double x = i % 317 + 0.5;
    const double y = i / 317 + 0.5;
    carpets.push_back(place.triangle({x, y, 0}, {x + 0.8, y, 0}, {x, y + 0.8, 0}));
  }
  EXPECT_EQ(find_coincident_triangles(carpets).triangles, carpets.size());
  EXPECT_EQ(find_coincident_triangles(carpets).groups, 1);
  carpets.erase(carpets.begin(), carpets.begin() + 2);
  EXPECT_EQ(find_coincident_triangles(carpets).triangles, 0u);
}

TEST(CoincidentTriangles, NoneAmongNone) {
  EXPECT_TRUE(find_coincident_triangles(std::vector<Triangle>{}).group.empty());
  EXPECT_EQ(find_coincident_triangles({Placement{}.triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0})}).triangles, 0u);
}

Scene scene_of(const std::vector<Triangle>& triangles) {
  Scene scene;
  scene.materials = {{"wall", glm::dvec3(0.5), glm::dvec3(0.0)}, {"lamp", glm::dvec3(0.0), glm::dvec3(1.0)}};
  scene.triangles = triangles;
  return scene;
}

TEST(CoincidentTriangles, AreNotedAndLightsComeFirst) {
  const glm::dvec3 a(0, 0, 0), b(4, 0, 0), c(4, 4, 0), d(0, 4, 0);
  Scene scene = scene_of({{{a, b, c}, 0}, {{a, c, d}, 0}, {{a * 0.5, b * 0.5, c * 0.5}, 1}, {{d, c, a}, 1}});
  order_coincident_triangles(scene, "room.toml");
  ASSERT_EQ(scene.notes.lines().size(), 1u);
  EXPECT_EQ(
      scene.notes.lines()[0],
      "room.toml: a triangle lies on another one in its plane: what faces the ray is seen, lights first, "
      "then what is listed first, 4 times");
  EXPECT_EQ(scene.coincident_triangles, 4u);
  std::vector<std::int32_t> materials;
  for (const Triangle& triangle : scene.triangles) materials.push_back(triangle.material);
  EXPECT_EQ(materials, (std::vector<std::int32_t>{1, 1, 0, 0}));
  EXPECT_EQ(scene.triangles[0].vertex[1], b * 0.5);
  EXPECT_EQ(scene.triangles[2].vertex[1], b);
}

TEST(CoincidentTriangles, AScenePartsOfWhichOnlyTouchKeepsItsOrder) {
  const glm::dvec3 a(0, 0, 0), b(4, 0, 0), c(4, 4, 0), d(0, 4, 0);
  Scene scene = scene_of({{{a, b, c}, 0}, {{a, c, d}, 1}});
  order_coincident_triangles(scene, "room.toml");
  EXPECT_TRUE(scene.notes.lines().empty());
  EXPECT_EQ(scene.coincident_triangles, 0u);
  EXPECT_EQ(scene.triangles[0].material, 0);
}

}  // namespace coincident_triangles_test
