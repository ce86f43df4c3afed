#pragma once

#include <cstdint>
#include <vector>

#include "firmware/path_tracer/geometry/layered_triangle_record.hpp"
#include "testbench/scene/coincident_triangles.hpp"
#include "testbench/scene/scene.hpp"

namespace testbench {

inline constexpr std::int32_t kNoPlane = -1;

/// The planes that triangles of a layered scene share. Of a face with coincident triangles, all triangles
/// that lie in one plane, up to rounding (SceneSize::plane_tolerance()), share it. A triangle of the face
/// that lies farther away keeps a plane of its own.
class SceneLayers {
 public:
  SceneLayers(const Scene& scene, const CoincidentTriangles& coincident,
              const std::vector<std::int32_t>& faces);

  const path_tracer::Layers& layers() const { return layers_; }
  /// Number of the plane that a triangle shares, or kNoPlane.
  std::int32_t plane_of(std::size_t triangle) const { return layers_.any ? plane_of_[triangle] : kNoPlane; }

  /// The triangle as rays meet it: laid into its shared plane.
  path_tracer::TriangleShape shape_of(const Triangle& triangle, std::size_t number) const;
  path_tracer::LayeredTriangleRecord record_of(const Triangle& triangle,
                                               const path_tracer::TrianglePlace& place) const;

 private:
  path_tracer::Layers layers_;
  std::vector<std::int32_t> plane_of_;
  std::vector<path_tracer::SharedPlane> planes_;
};

}  // namespace testbench
