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

int edge_exponent(const TriangleRecord& triangle) {
  const double largest = std::max(largest_component(triangle.edge1), largest_component(triangle.edge2));
  return largest > 0 ? -std::ilogb(largest) - 1 : 0;
}

}  // namespace

PrefilterTriangle prefilter_triangle(const TriangleRecord& triangle, const Layers& layers,
                                     const vec3<double>& anchor, double unit) {
  const vec3<double> back = layers.any ? triangle.back * layered(triangle).area_ratio : triangle.back;
  const int of_edges = edge_exponent(triangle);
  const int of_coordinates = std::ilogb(unit);
  return {narrow(triangle.vertex - anchor, of_coordinates), narrow(triangle.edge1 * -1.0, of_edges),
          narrow(triangle.edge2, of_edges), narrow(back, of_edges + of_coordinates), triangle.face};
}

double prefilter_scale(const TriangleRecord& triangle, double unit) {
  return std::ldexp(unit, edge_exponent(triangle));
}

Prefilter make_prefilter(const TriangleRecord* first, int count, double reach, const Layers& layers) {
  Prefilter prefilter;
  if (count == 0) return prefilter;
  prefilter.anchor = first->vertex;
  prefilter.unit = to_node_unit(NodeFormat::fp32, reach);
  prefilter.triangles.reserve(std::size_t(count));
  for (int i = 0; i < count; ++i) {
    const TriangleRecord& triangle = triangle_at(first, i, layers.record_bytes());
    prefilter.triangles.push_back(prefilter_triangle(triangle, layers, prefilter.anchor, prefilter.unit));
  }
  return prefilter;
}

}  // namespace path_tracer
