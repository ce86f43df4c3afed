#include "testbench/scene/polygon_crossings.hpp"

#include <algorithm>
#include <cmath>

namespace testbench {
namespace {

constexpr std::size_t kMostCrossingsPerEdge = 8;
constexpr std::size_t kMostPairs = 200'000'000;

struct Edge {
  glm::dvec2 a;
  glm::dvec2 b;

  double low(int axis) const { return std::min(a[axis], b[axis]); }
  double high(int axis) const { return std::max(a[axis], b[axis]); }
};

/// Twice the area of a triangle, positive if it runs counter-clockwise.
double area(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Whether two edges cross between their ends. Rounding may decide where they touch: the count is a bound of
/// the work, not of the picture.
bool do_cross(const Edge& e, const Edge& f) {
  return area(e.a, e.b, f.a) * area(e.a, e.b, f.b) < 0.0 && area(f.a, f.b, e.a) * area(f.a, f.b, e.b) < 0.0;
}

std::vector<Edge> edges_of(const std::vector<glm::dvec2>& outline) {
  std::vector<Edge> edges;
  edges.reserve(outline.size());
  for (std::size_t i = 0; i < outline.size(); ++i)
    edges.push_back({outline[i], outline[(i + 1) % outline.size()]});
  return edges;
}

/// The axis along which edges are shorter, so that fewer of them lie side by side.
int sweep_axis(const std::vector<Edge>& edges) {
  glm::dvec2 total(0.0);
  for (const Edge& edge : edges) total += glm::abs(edge.b - edge.a);
  return total.x <= total.y ? 0 : 1;
}

}  // namespace

bool has_few_crossings(const std::vector<glm::dvec2>& outline) {
  std::vector<Edge> edges = edges_of(outline);
  const int axis = sweep_axis(edges);
  std::sort(edges.begin(), edges.end(),
            [&](const Edge& e, const Edge& f) { return e.low(axis) < f.low(axis); });
  std::size_t crossings = 0;
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    for (std::size_t k = i + 1; k < edges.size() && edges[k].low(axis) <= edges[i].high(axis); ++k) {
      if (++pairs > kMostPairs) return false;
      if (do_cross(edges[i], edges[k]) && ++crossings > kMostCrossingsPerEdge * edges.size()) return false;
    }
  }
  return true;
}

}  // namespace testbench
