#include "firmware/path_tracer/prefilter/prefilter.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/path_tracer/records/node_layout.hpp"

namespace path_tracer {
namespace {

double largest_component(const vec3<double>& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

std::array<float, 3> narrow(const vec3<double>& v, int exponent) {
  return {float(std::ldexp(v.x, exponent)), float(std::ldexp(v.y, exponent)),
          float(std::ldexp(v.z, exponent))};
}

/// @param back edge2 x edge1, scaled as the edges
PrefilterTriangle prefilter_triangle(const TriangleRecord& triangle, const vec3<double>& back,
                                     const vec3<double>& anchor, int unit_exponent) {
  const double largest = std::max(largest_component(triangle.edge1), largest_component(triangle.edge2));
  const int edge_exponent = largest > 0 ? -std::ilogb(largest) - 1 : 0;
  return {narrow(triangle.vertex - anchor, unit_exponent), narrow(triangle.edge1 * -1.0, edge_exponent),
          narrow(triangle.edge2, edge_exponent), narrow(back, edge_exponent + unit_exponent), triangle.face};
}

}  // namespace

Prefilter make_prefilter(const TriangleRecord* first, int count, double reach, const Layers& layers) {
  Prefilter prefilter;
  if (count == 0) return prefilter;
  prefilter.anchor = first->vertex;
  prefilter.unit = to_node_unit(NodeFormat::fp32, reach);
  prefilter.triangles.reserve(std::size_t(count));
  for (int i = 0; i < count; ++i) {
    const TriangleRecord& triangle = triangle_at(first, i, layers.record_bytes());
    const vec3<double> back = layers.any ? triangle.back * layered(triangle).area_ratio : triangle.back;
    prefilter.triangles.push_back(
        prefilter_triangle(triangle, back, prefilter.anchor, std::ilogb(prefilter.unit)));
  }
  return prefilter;
}

}  // namespace path_tracer
