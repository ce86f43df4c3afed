#include "tests/support/search_meshes.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "testbench/bvh/bvh.hpp"
#include "testbench/scene/coincident_triangles.hpp"
#include "testbench/scene/mesh.hpp"
#include "testbench/scene_file/generated_scene.hpp"
#include "tests/support/meshes.hpp"

namespace test_support {

using testbench::Scene;
using testbench::Triangle;

namespace {

std::vector<Triangle> scaled(std::vector<Triangle> triangles, double factor) {
  for (Triangle& triangle : triangles)
    for (glm::dvec3& vertex : triangle.vertex) vertex *= factor;
  return triangles;
}

/// Rectangles across the axes, some side by side, some intersecting. All their boxes are flat.
std::vector<Triangle> flats() {
  std::vector<Triangle> triangles;
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < 40; ++i) {
      glm::dvec3 corner(0.0), u(0.0), v(0.0);
      corner[axis] = i / 8;
      u[(axis + 1) % 3] = 1.0;
      v[(axis + 2) % 3] = 1.0;
      corner += u * double(i % 8) + v * double(i % 5);
      triangles.push_back(triangle(corner, corner + u, corner + u + v));
      triangles.push_back(triangle(corner, corner + u + v, corner + v));
    }
  return triangles;
}

/// Nested triangles around one point.
std::vector<Triangle> nested() {
  std::vector<Triangle> triangles;
  for (const Triangle& triangle : soup(1, 0.0, 1.0, 9))
    for (double size = 1.0; size > 1e-9; size *= 0.7) triangles.push_back(scaled({triangle}, size).front());
  return triangles;
}

/// Overlapping triangles in one plane that is parallel to no axis.
std::vector<Triangle> slanted() {
  std::vector<Triangle> triangles = soup(60, 1.0, 0.5, 10);
  const glm::dvec3 u = glm::normalize(glm::dvec3(1, 2, 3));
  const glm::dvec3 v = glm::normalize(glm::cross(u, glm::dvec3(0.3, -1, 0.2)));
  for (Triangle& triangle : triangles)
    for (glm::dvec3& vertex : triangle.vertex) vertex = u * vertex.x + v * vertex.y;
  return triangles;
}

/// Puts triangles of the plane z = 0 into a plane that is parallel to no axis, that far from the origin.
std::vector<Triangle> tilted(std::vector<Triangle> triangles, double shift) {
  const glm::dvec3 u = glm::normalize(glm::dvec3(-2, 1, 0.7));
  const glm::dvec3 v = glm::normalize(glm::cross(u, glm::dvec3(0.4, 0.2, 1)));
  const glm::dvec3 w = glm::cross(u, v);
  for (Triangle& triangle : triangles)
    for (glm::dvec3& vertex : triangle.vertex)
      vertex = u * vertex.x + v * vertex.y + w * vertex.z + glm::dvec3(0.8, -1, 0.3) * shift;
  return triangles;
}

void add_quad(std::vector<Triangle>& triangles, const glm::dvec3& corner, const glm::dvec3& a,
              const glm::dvec3& b) {
  triangles.push_back(triangle(corner, corner + a, corner + a + b));
  triangles.push_back(triangle(corner, corner + a + b, corner + b));
}

/// A floor of two triangles with carpets of every size and either side up; walls back to back, one of them
/// cut the other way; a box that stands on the floor.
std::vector<Triangle> layers() {
  std::vector<Triangle> triangles;
  add_quad(triangles, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
  std::mt19937_64 random(21);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  for (double size = 1.0; size > 1e-5; size *= 0.7) {
    const auto point = [&](const glm::dvec2& at) {
      return glm::dvec3(at.x + size * number(random), at.y + size * number(random), 0.0);
    };
    const glm::dvec2 at(number(random), number(random));
    triangles.push_back(triangle(point(at), point(at), point(at)));
  }
  add_quad(triangles, {-1, 0, -0.5}, {2, 0, 0}, {0, 0, 1});
  add_quad(triangles, {1, 0, -0.5}, {-2, 0, 0}, {0, 0, 1});
  triangles.push_back(triangle({-1, 0, -0.5}, {-1, 0, 0.5}, {1, 0, 0.5}));
  for (int side = 0; side < 2; ++side) {
    add_quad(triangles, {0.3, 0.2, 0.5 * side}, {0.5, 0, 0}, {0, 0.4, 0});
    add_quad(triangles, {0.3 + 0.5 * side, 0.2, 0}, {0, 0, 0.5}, {0, 0.4, 0});
    add_quad(triangles, {0.3, 0.2 + 0.4 * side, 0}, {0, 0, 0.5}, {0.5, 0, 0});
  }
  add_quad(triangles, {-0.4, -0.4, 0}, {0, 0.3, 0}, {0.3, 0, 0});
  triangles.push_back(triangle({-0.5, -0.2, 0}, {0.5, -0.25, 0}, {0, -0.7, 0}));
  return triangles;
}

/// The mesh, cut to a size that takes little time if rays test every triangle, as with needles and
/// duplicates.
std::vector<Triangle> cut_to_size(Mesh mesh, std::size_t most) {
  std::vector<Triangle> triangles = test_support::mesh(mesh);
  if (triangles.size() > most) triangles.resize(most);
  return triangles;
}

std::vector<Triangle> three_times(const std::vector<Triangle>& once) {
  std::vector<Triangle> triangles;
  for (int i = 0; i < 3; ++i) triangles.insert(triangles.end(), once.begin(), once.end());
  return triangles;
}

std::vector<Triangle> generated(testbench::GeneratedScene kind) {
  return testbench::generate_scene(kind, 400).triangles;
}

}  // namespace

std::vector<Triangle> decals() {
  std::vector<Triangle> triangles = slanted();
  const glm::dvec3 u = triangles[0].vertex[0];
  const glm::dvec3 v = triangles[1].vertex[1];
  const glm::dvec3 middle = u * 0.1;
  for (int i = 0; i < 3; ++i) {
    const auto rim = [&](int k) { return middle + u * std::cos(2.1 * k) + v * std::sin(2.1 * k); };
    triangles.push_back(triangle(middle, rim(i), rim(i + 1)));
  }
  return triangles;
}

std::vector<NamedMesh> search_meshes() {
  using testbench::GeneratedScene;
  return {{"one", [] { return mesh(Mesh::one); }},
          {"coplanar", [] { return mesh(Mesh::coplanar); }},
          {"soup", [] { return cut_to_size(Mesh::soup, 1000); }},
          {"needles", [] { return cut_to_size(Mesh::needles, 100); }},
          {"duplicates", [] { return cut_to_size(Mesh::duplicates, 50); }},
          {"scales", [] { return mesh(Mesh::scales); }},
          {"huge", [] { return scaled(cut_to_size(Mesh::huge, 100), 1e-200); }},
          {"tiny", [] { return scaled(cut_to_size(Mesh::tiny, 100), 1e230); }},
          {"large_triangles", [] { return soup(60, 1.0, 1.0, 11); }},
          {"flats", flats},
          {"nested", nested},
          {"slanted", slanted},
          {"layers", layers},
          {"tilted_layers", [] { return tilted(layers(), 0.0); }},
          {"large_tilted_layers", [] { return scaled(tilted(layers(), 0.0), 1e30); }},
          {"far_tilted_layers", [] { return tilted(layers(), 1e6); }},
          {"threefold_soup", [] { return three_times(soup(40, 1.0, 0.3, 12)); }},
          {"far_from_the_origin",
           [] {
             std::vector<Triangle> triangles = soup(100, 1.0, 0.2, 13);
             for (Triangle& triangle : triangles)
               for (glm::dvec3& vertex : triangle.vertex) vertex += glm::dvec3(1e6, -1e8, 3e7);
             return triangles;
           }},
          {"blob", [] { return generated(GeneratedScene::blob); }},
          {"sphere_flake", [] { return generated(GeneratedScene::sphere_flake); }},
          {"stadium", [] { return generated(GeneratedScene::stadium); }},
          {"long_needles", [] { return generated(GeneratedScene::needles); }}};
}

Scene scene_of(std::vector<Triangle> triangles) {
  triangles.erase(std::remove_if(triangles.begin(), triangles.end(), testbench::is_degenerate),
                  triangles.end());
  Scene scene;
  scene.name = "mesh";
  scene.film = {4, 4};
  scene.materials = {{"dark", glm::dvec3(0.5), glm::dvec3(0.0)},
                     {"shining", glm::dvec3(0.0), glm::dvec3(1.0)}};
  testbench::Box box;
  for (Triangle& triangle : triangles) {
    triangle.material = 0;
    box.include(bounds_of(triangle));
  }
  for (std::size_t i = 0; i < std::min<std::size_t>(3, triangles.size()); ++i)
    triangles[triangles.size() - 1 - i].material = 1;
  const glm::dvec3 size = box.upper - box.lower;
  scene.camera.position = box.lower - 0.25 * std::max({size.x, size.y, size.z});
  scene.triangles = std::move(triangles);
  testbench::order_coincident_triangles(scene, scene.name);
  return scene;
}

}  // namespace test_support
