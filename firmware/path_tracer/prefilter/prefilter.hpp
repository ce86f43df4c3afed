#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "firmware/path_tracer/records/records.hpp"

/// The simulator's prefilter of brute force. The chip has none: every PE tests every triangle, which takes a
/// known time. A test without a crossing changes nothing, so the simulator need not execute it
/// (prefilter_search.hpp).
namespace path_tracer {

/// A triangle in single precision. Coordinates are relative to the prefilter's anchor, in its unit; edges are
/// scaled by a power of two that makes their largest component 0.5 to 1. `back` is in the unit of a
/// coordinate times that of an edge.
struct PrefilterTriangle {
  std::array<float, 3> vertex;
  std::array<float, 3> minus_edge1;
  std::array<float, 3> edge2;
  std::array<float, 3> back;
  std::int32_t face;
};

/// Tells which triangles a ray may cross; a ray misses all others for certain.
struct Prefilter {
  vec3<double> anchor{};
  double unit = 1;  ///< factor of coordinates, a power of two; `reach` is 1 to 2 units
  std::vector<PrefilterTriangle> triangles;
};

/// @param anchor, unit those of Prefilter
PrefilterTriangle prefilter_triangle(const TriangleRecord& triangle, const Layers& layers,
                                     const vec3<double>& anchor, double unit);

/// Returns the power of two by which a PrefilterTriangle's determinants exceed those of the record.
double prefilter_scale(const TriangleRecord& triangle, double unit);

/// @param reach no ray starts farther from a vertex, and no vertex is farther from another
Prefilter make_prefilter(const TriangleRecord* first, int count, double reach, const Layers& layers = {});

}  // namespace path_tracer
