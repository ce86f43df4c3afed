#include "testbench/mono_image/faces.hpp"

#include <gtest/gtest.h>

#include "tests/support/scenes.hpp"

namespace faces_test {

using testbench::number_faces;
using testbench::Scene;
using testbench::Triangle;

TEST(Faces, NeighboursInOnePlaneShare) {
  // A quad, a neighbour in its plane, and a neighbour that is folded up slightly.
  const glm::dvec3 a(0, 0, 0), b(1, 0, 0), c(1, 1, 0), d(0, 1, 0), e(2, 0, 0), f(2, 1, 0), up(0, 2, 1e-6);
  EXPECT_EQ(number_faces({{{a, b, c}, 0}, {{a, c, d}, 0}, {{b, e, f}, 0}, {{b, f, c}, 0}, {{d, c, up}, 0}}),
            (std::vector<std::int32_t>{0, 0, 0, 0, 1}));
}

TEST(Faces, OrderAndMaterialDoNotMatter) {
  const glm::dvec3 a(0, 0, 0), b(1, 0, 0), c(1, 1, 0), d(0, 1, 0), e(2, 0, 0), f(2, 1, 0);
  // The first and the second touch only through the third.
  EXPECT_EQ(number_faces({{{d, a, c}, 0}, {{b, e, f}, 1}, {{a, b, c}, 2}, {{b, f, c}, 0}}),
            (std::vector<std::int32_t>{0, 0, 0, 0}));
}

TEST(Faces, WindingDoesNotMatter) {
  const glm::dvec3 a(0, 0, 0), b(1, 0, 0), c(1, 1, 0), d(0, 1, 0);
  EXPECT_EQ(number_faces({{{a, b, c}, 0}, {{a, d, c}, 0}}), (std::vector<std::int32_t>{0, 0}));
}

TEST(Faces, SlantedPlanesAreRecognisedInSpiteOfRounding) {
  const auto turned = [](double x, double y) {
    const glm::dvec3 u = glm::normalize(glm::dvec3(1, 2, 3));
    const glm::dvec3 v = glm::normalize(glm::cross(u, glm::dvec3(0.3, -1, 0.2)));
    return glm::dvec3(100, -70, 30) + u * x + v * y;
  };
  std::vector<Triangle> triangles;
  for (int i = 0; i < 20; ++i) {
    const glm::dvec3 p[4] = {turned(i / 3.0, 0), turned((i + 1) / 3.0, 0), turned((i + 1) / 3.0, 1),
                             turned(i / 3.0, 1)};
    triangles.push_back({{p[0], p[1], p[2]}, 0});
    triangles.push_back({{p[0], p[2], p[3]}, 0});
  }
  for (const std::int32_t face : number_faces(triangles)) EXPECT_EQ(face, 0);
}

TEST(Faces, TouchingInAPointOrAPartOfAnEdgeIsNotEnough) {
  const glm::dvec3 a(0, 0, 0), b(2, 0, 0), c(0, 2, 0);
  // Two triangles in the same plane: one shares a corner, one shares half of an edge (a T-junction).
  EXPECT_EQ(number_faces({{{a, b, c}, 0}, {{b, {4, 0, 0}, {4, 2, 0}}, 0}, {{a, {1, 0, 0}, {0, -1, 0}}, 0}}),
            (std::vector<std::int32_t>{0, 1, 2}));
}

TEST(Faces, WhatLiesOnOneAnotherInAPlaneSharesWithAllThatEdgesConnect) {
  const glm::dvec3 a(0, 0, 0), b(4, 0, 0), c(4, 4, 0), d(0, 4, 0), up(0, 0, 4);
  // A floor, two carpets that touch different halves of it, one of them upside down, and a wall.
  EXPECT_EQ(number_faces({{{a, b, c}, 0},
                          {{a, c, d}, 0},
                          {{{2, 1, 0}, {3, 1, 0}, {3, 2, 0}}, 0},
                          {{{1, 2, 0}, {1, 3, 0}, {2, 3, 0}}, 0},
                          {{a, b, up}, 0}}),
            (std::vector<std::int32_t>{0, 0, 0, 0, 3}));
}

TEST(Faces, ParallelPlanesAreApart) {
  EXPECT_EQ(number_faces({{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, 0}, {{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}}, 0}}),
            (std::vector<std::int32_t>{0, 1}));
}

TEST(Faces, ACubeHasSix) {
  const Scene cube = test_support::closed_cube(0.5, 0.5, {4, 4});
  const std::vector<std::int32_t> faces = number_faces(cube.triangles);
  ASSERT_EQ(faces.size(), 12u);
  for (std::size_t i = 0; i < 12; ++i) EXPECT_EQ(faces[i], std::int32_t(i / 2));
}

TEST(Faces, NoneForNoTriangles) {
  EXPECT_TRUE(number_faces({}).empty());
}

/// Comparing each triangle with all others would take 10^12 steps, more than a test has time for.
TEST(Faces, AMillionDuplicatesShareOneWithoutLookingAtEachOther) {
  const Triangle triangle{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, 0};
  const std::vector<std::int32_t> faces = number_faces(std::vector<Triangle>(1000000, triangle));
  ASSERT_EQ(faces.size(), 1000000u);
  for (const std::int32_t face : faces) ASSERT_EQ(face, 0);
}

}  // namespace faces_test
