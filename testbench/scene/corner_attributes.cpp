#include "testbench/scene/corner_attributes.hpp"

#include <algorithm>
#include <cmath>

namespace testbench {
namespace {

double largest_component(const glm::dvec3& vector) {
  return std::max({std::abs(vector.x), std::abs(vector.y), std::abs(vector.z)});
}

template <class Entry>
void set_entry(std::vector<Entry>& list, std::size_t index, const std::optional<Entry>& entry) {
  if (!entry) return;
  list.resize(index + 1, Entry{});
  list[index] = *entry;
}

template <class Entry>
std::optional<Entry> entry_of(const std::vector<Entry>& list, std::size_t index) {
  if (index >= list.size()) return std::nullopt;
  return list[index];
}

template <class Entry>
void remove_entries(std::vector<Entry>& list, const std::vector<bool>& is_removed) {
  std::size_t next = 0;
  for (std::size_t i = 0; i < list.size(); ++i)
    if (!is_removed[i]) list[next++] = list[i];
  list.resize(next);
}

}  // namespace

glm::dvec3 unit_or_zero(const glm::dvec3& vector) {
  const double largest = largest_component(vector);
  if (!(largest > 0.0) || !std::isfinite(vector.x + vector.y + vector.z)) return glm::dvec3(0.0);
  return glm::normalize(vector / largest);
}

std::optional<CornerNormals> corner_normals(const glm::dvec3 (&vertex)[3], const CornerNormals& given) {
  constexpr double kLeastSine = 1e-4;
  const glm::dvec3 of_plane =
      unit_or_zero(glm::cross(unit_or_zero(vertex[1] - vertex[0]), unit_or_zero(vertex[2] - vertex[0])));
  CornerNormals normals;
  double facing = 0.0;
  bool is_flat = true;
  for (std::size_t i = 0; i < 3; ++i) {
    normals[i] = unit_or_zero(given[i]);
    if (normals[i] == glm::dvec3(0.0)) return std::nullopt;
    facing += glm::dot(normals[i], of_plane);
    is_flat = is_flat && glm::length(glm::cross(normals[i], of_plane)) < kLeastSine;
  }
  if (is_flat) return std::nullopt;
  if (facing < 0.0)
    for (glm::dvec3& normal : normals) normal = -normal;
  return normals;
}

std::optional<CornerTangents> corner_tangents(const glm::dvec3 (&vertex)[3], const CornerNormals& normals,
                                              const CornerTangents& given) {
  const glm::dvec3 of_plane =
      glm::cross(unit_or_zero(vertex[1] - vertex[0]), unit_or_zero(vertex[2] - vertex[0]));
  double facing = 0.0;
  for (const glm::dvec3& normal : normals) facing += glm::dot(unit_or_zero(normal), of_plane);
  CornerTangents tangents;
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec3 direction = unit_or_zero(glm::dvec3(given[i]));
    const bool has_side = given[i].w < 0.0 || given[i].w > 0.0;
    if (direction == glm::dvec3(0.0) || !has_side || (given[i].w < 0.0) != (given[0].w < 0.0))
      return std::nullopt;
    tangents[i] = glm::dvec4(direction, (given[i].w < 0.0) == (facing < 0.0) ? 1.0 : -1.0);
  }
  return tangents;
}

CornerTangents moved_tangents(const CornerTangents& tangents, const glm::dmat3& transform) {
  const double side = glm::determinant(transform) < 0.0 ? -1.0 : 1.0;
  CornerTangents moved;
  for (std::size_t i = 0; i < 3; ++i)
    moved[i] = glm::dvec4(unit_or_zero(transform * glm::dvec3(tangents[i])), side * tangents[i].w);
  return moved;
}

CornerCoordinates corner_coordinates(CornerCoordinates given) {
  for (glm::dvec2& of_corner : given)
    for (int axis = 0; axis < 2; ++axis)
      if (!std::isfinite(of_corner[axis])) of_corner[axis] = 0.0;
  return given;
}

glm::dmat3 normal_transform(const glm::dmat3& transform) {
  const double largest = std::max(
      {largest_component(transform[0]), largest_component(transform[1]), largest_component(transform[2])});
  const glm::dmat3 scaled =
      largest > 0.0 ? transform / largest : transform;  // products neither vanish nor overflow
  const glm::dmat3 cofactors(glm::cross(scaled[1], scaled[2]), glm::cross(scaled[2], scaled[0]),
                             glm::cross(scaled[0], scaled[1]));
  return glm::determinant(scaled) < 0.0 ? -cofactors : cofactors;
}

void set_corner_attributes(CornerAttributes& attributes, std::size_t index,
                           const TriangleAttributes& of_one) {
  set_entry(attributes.normals, index, of_one.normals);
  for (std::size_t set = 0; set < attributes.coordinates.size(); ++set)
    set_entry(attributes.coordinates[set], index, of_one.coordinates[set]);
  set_entry(attributes.tangents, index, of_one.tangents);
}

TriangleAttributes corner_attributes_of(const CornerAttributes& attributes, std::size_t index) {
  TriangleAttributes of_one;
  of_one.normals = entry_of(attributes.normals, index);
  for (std::size_t set = 0; set < attributes.coordinates.size(); ++set)
    of_one.coordinates[set] = entry_of(attributes.coordinates[set], index);
  of_one.tangents = entry_of(attributes.tangents, index);
  return of_one;
}

void complete_corner_attributes(CornerAttributes& attributes, std::size_t triangles) {
  if (!attributes.normals.empty()) attributes.normals.resize(triangles, CornerNormals{});
  for (std::vector<CornerCoordinates>& of_set : attributes.coordinates)
    if (!of_set.empty()) of_set.resize(triangles, CornerCoordinates{});
  if (!attributes.tangents.empty()) attributes.tangents.resize(triangles, CornerTangents{});
}

void reorder_corner_attributes(CornerAttributes& attributes, const std::vector<std::size_t>& order) {
  const auto reorder = [&](auto& list) {
    if (list.empty()) return;
    auto reordered = list;
    for (std::size_t i = 0; i < order.size(); ++i) reordered[i] = list[order[i]];
    list = std::move(reordered);
  };
  reorder(attributes.normals);
  for (auto& coordinates : attributes.coordinates) reorder(coordinates);
  reorder(attributes.tangents);
}

void remove_corner_attributes(CornerAttributes& attributes, const std::vector<bool>& is_removed) {
  remove_entries(attributes.normals, is_removed);
  for (std::vector<CornerCoordinates>& of_set : attributes.coordinates) remove_entries(of_set, is_removed);
  remove_entries(attributes.tangents, is_removed);
}

}  // namespace testbench
