#pragma once

#include <array>
#include <cstddef>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "testbench/texture/texture.hpp"

namespace testbench {

using CornerNormals = std::array<glm::dvec3, 3>;
using CornerCoordinates = std::array<glm::dvec2, 3>;
using CornerTangents = std::array<glm::dvec4, 3>;

/// What a list of triangles has at their corners. A list is empty if no triangle has such, otherwise it has
/// an entry for each triangle.
struct CornerAttributes {
  /// Unit length, on the triangle's front side as a whole; three zeros for a flat triangle, whose normal is
  /// that of its plane.
  std::vector<CornerNormals> normals;
  /// Texture coordinates by set, as TextureReference has them; zeros for a triangle without.
  std::array<std::vector<CornerCoordinates>, kTextureCoordinateSets> coordinates;

  /// Tangents that a file gives (glTF 2.0, section 3.7.2.1): x, y, z of unit length, along which a normal
  /// texture's columns grow; w, +1 or -1, turns normal x tangent upwards in the image. Zeros for a triangle
  /// without: they follow from its texture coordinates.
  std::vector<CornerTangents> tangents;

  bool is_empty() const {
    return normals.empty() && coordinates[0].empty() && coordinates[1].empty() && tangents.empty();
  }
};

/// The same of one triangle.
struct TriangleAttributes {
  std::optional<CornerNormals> normals;
  std::array<std::optional<CornerCoordinates>, kTextureCoordinateSets> coordinates;
  std::optional<CornerTangents> tangents;
};

/// The vector with a length of 1, also where its square would vanish or overflow; zeros for what is no
/// direction.
glm::dvec3 unit_or_zero(const glm::dvec3& vector);

/// The normals for a triangle: of unit length and turned to its front; std::nullopt if one is no direction,
/// or if all lie within 1e-4 radians of the normal of its plane, so that nothing is to be seen of them.
/// @param vertex of the triangle, counter-clockwise from its front
std::optional<CornerNormals> corner_normals(const glm::dvec3 (&vertex)[3], const CornerNormals& given);

/// The tangents for a triangle: of unit length, with the side of its front; std::nullopt if one is no
/// direction, or if the corners do not agree on the side.
/// @param vertex of the triangle, counter-clockwise from its front @param normals that the tangents go with
std::optional<CornerTangents> corner_tangents(const glm::dvec3 (&vertex)[3], const CornerNormals& normals,
                                              const CornerTangents& given);

/// The tangents in a mesh that is moved. @param transform of points
CornerTangents moved_tangents(const CornerTangents& tangents, const glm::dmat3& transform);

/// The coordinates, with 0 in place of what is no finite number.
CornerCoordinates corner_coordinates(CornerCoordinates given);

/// The matrix that turns normals as `transform` moves points: its inverse transpose, but for the length. Also
/// for a transform without inverse.
glm::dmat3 normal_transform(const glm::dmat3& transform);

/// Sets what triangle `index` has. Those before it may be missing; they have nothing then.
void set_corner_attributes(CornerAttributes& attributes, std::size_t index, const TriangleAttributes& of_one);

/// What triangle `index` has.
TriangleAttributes corner_attributes_of(const CornerAttributes& attributes, std::size_t index);

/// Gives each list that is not empty an entry for each of `triangles` triangles.
void complete_corner_attributes(CornerAttributes& attributes, std::size_t triangles);

/// Puts the entries in another order. @param attributes complete @param order the old index of each new entry
void reorder_corner_attributes(CornerAttributes& attributes, const std::vector<std::size_t>& order);

/// Removes the entries of the triangles that are marked. @param attributes complete
void remove_corner_attributes(CornerAttributes& attributes, const std::vector<bool>& is_removed);

}  // namespace testbench
