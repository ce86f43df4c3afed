#pragma once

#include <array>
#include <vector>

#include "testbench/scene/scene.hpp"

namespace testbench {

/// Sizes that a scene's rounding is relative to.
struct SceneSize {
  double extent = 0;  ///< length of the diagonal of the triangles' box
  double reach = 0;   ///< at least the extent and at least the size of any coordinate when it was rounded

  /// Vertices whose coordinates were rounded to doubles lie within 2^-52 of `reach` of a plane, and hits
  /// within 10 times 2^-53; this leaves room for coordinates that took several operations. It also is the
  /// width up to which triangles may overlap and count as touching.
  double plane_tolerance() const { return 0x1p-46 * reach; }
  /// No triangle is found that is thinner: rounding alone may turn its plane anywhere.
  double least_height() const { return 0x1p-34 * reach; }
};

/// @param rounded_at Scene::rounded_at
SceneSize size_of(const std::vector<Triangle>& triangles, double rounded_at);

/// A plane through a point; the normal has unit length.
struct FittedPlane {
  glm::dvec3 point;
  glm::dvec3 normal;
};

/// The plane through three of the points that lie far apart.
FittedPlane fit_plane(const std::vector<glm::dvec3>& points);

/// The height of a triangle on its longest edge.
double height_of(const Triangle& triangle);

/// A triangle as seen along an axis, counter-clockwise.
using Silhouette = std::array<glm::dvec2, 3>;
Silhouette seen_along(int axis, const Triangle& triangle, const glm::dvec3& origin);

/// Whether two silhouettes overlap by an area, not only along an edge.
bool overlap(const Silhouette& a, const Silhouette& b, const SceneSize& size);

bool lie_in_one_plane(const Triangle& a, const Triangle& b, const SceneSize& size);

/// Whether two triangles lie in one plane and overlap there.
bool coincide(const Triangle& a, const Triangle& b, const SceneSize& size);

}  // namespace testbench
