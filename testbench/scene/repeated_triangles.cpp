#include "testbench/scene/repeated_triangles.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "testbench/scene/exact_coordinates.hpp"

namespace testbench {
namespace {

using Coordinates = std::array<double, 9>;

/// The coordinates of the vertices from the least one on.
Coordinates coordinates_of(const Triangle& triangle) {
  const auto is_less = [](const glm::dvec3& a, const glm::dvec3& b) {
    return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
  };
  const auto first =
      std::size_t(std::min_element(triangle.vertex, triangle.vertex + 3, is_less) - triangle.vertex);
  Coordinates coordinates;
  for (std::size_t i = 0; i < 9; ++i)
    coordinates[i] = triangle.vertex[(first + i / 3) % 3][int(i % 3)] + 0.0;  // + 0.0 makes -0 to 0
  return coordinates;
}

struct HashedTriangle {
  std::uint64_t hash;
  std::size_t index;
};

}  // namespace

std::size_t remove_repeated_triangles(Scene& scene) {
  std::vector<HashedTriangle> hashed;
  hashed.reserve(scene.triangles.size());
  for (std::size_t i = 0; i < scene.triangles.size(); ++i)
    hashed.push_back({hash_of_coordinates(coordinates_of(scene.triangles[i])), i});
  std::sort(hashed.begin(), hashed.end(), [](const HashedTriangle& a, const HashedTriangle& b) {
    return a.hash != b.hash ? a.hash < b.hash : a.index < b.index;
  });
  const auto emits = [&scene](std::size_t index) {
    return scene.materials[std::size_t(scene.triangles[index].material)].emission != glm::dvec3(0.0);
  };
  std::vector<bool> is_removed(scene.triangles.size(), false);
  std::size_t removed = 0;
  for (std::size_t i = 1; i < hashed.size(); ++i) {
    if (hashed[i].hash != hashed[i - 1].hash) continue;
    // Equal triangles stand side by side in practice: two different ones of one hash are not expected ever,
    // and would only cost that a repeated one stays.
    std::size_t& kept = hashed[i - 1].index;
    std::size_t& other = hashed[i].index;
    if (coordinates_of(scene.triangles[kept]) != coordinates_of(scene.triangles[other])) continue;
    if (emits(kept) || !emits(other)) std::swap(kept, other);  // the one that stays is compared with the next
    is_removed[kept] = true;
    ++removed;
  }
  if (removed == 0) return 0;
  std::size_t next = 0;
  for (std::size_t i = 0; i < scene.triangles.size(); ++i)
    if (!is_removed[i]) scene.triangles[next++] = scene.triangles[i];
  scene.triangles.resize(next);
  remove_corner_attributes(scene.corners, is_removed);
  return removed;
}

}  // namespace testbench
