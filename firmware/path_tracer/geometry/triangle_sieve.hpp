#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "firmware/path_tracer/records/records.hpp"

namespace path_tracer {

/// A triangle in single precision: coordinates from the sieve's anchor on in its unit, the edges times a
/// power of two that makes their largest component 0.5 to 1. `back` is in the unit of a coordinate times that
/// of an edge.
struct SieveTriangle {
  std::array<float, 3> vertex;
  std::array<float, 3> minus_edge1;
  std::array<float, 3> edge2;
  std::array<float, 3> back;
  std::int32_t face;
};

/// Tells the host which triangles a ray crosses perhaps, and which for certain not. The chip knows nothing of
/// it: every PE tests every triangle, which takes a time that is known, but a test without a crossing changes
/// nothing, so the host need not carry it out (sifted_search.hpp).
struct TriangleSieve {
  vec3<double> anchor{};
  double unit = 1;  ///< factor of coordinates, a power of two; `reach` is 1 to 2
  std::vector<SieveTriangle> triangles;
};

/// @param reach no ray starts farther from a vertex, and no vertex is farther from another
TriangleSieve make_sieve(const TriangleRecord* first, int count, double reach);

}  // namespace path_tracer
