#include "testbench/mono_image/faces.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <unordered_map>

#include "firmware/path_tracer/records/records.hpp"
#include "testbench/scene/exact_coordinates.hpp"

namespace testbench {
namespace {

/// A vertex as a key for look-up by its exact coordinates.
struct Point {
  std::array<double, 3> coordinate;

  explicit Point(const glm::dvec3& p) : coordinate{p.x + 0.0, p.y + 0.0, p.z + 0.0} {}  // turns -0 into 0
  bool operator==(const Point& other) const { return coordinate == other.coordinate; }
};

struct HashOfPoint {
  std::size_t operator()(const Point& point) const { return hash_of_coordinates(point.coordinate); }
};

/// The triangles at each edge. Edges of triangles that have the same two vertices form a group.
class Edges {
 public:
  explicit Edges(const std::vector<Triangle>& triangles) : group_(3 * triangles.size()) {
    std::unordered_map<Point, std::uint32_t, HashOfPoint> vertices;
    vertices.reserve(triangles.size());
    const auto vertex = [&](const glm::dvec3& p) {
      return std::uint64_t{vertices.emplace(Point(p), std::uint32_t(vertices.size())).first->second};
    };
    std::vector<Use> uses;
    uses.reserve(3 * triangles.size());
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      const std::uint64_t corner[3] = {vertex(triangles[i].vertex[0]), vertex(triangles[i].vertex[1]),
                                       vertex(triangles[i].vertex[2])};
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint64_t a = corner[k];
        const std::uint64_t b = corner[(k + 1) % 3];
        uses.push_back({std::min(a, b) << 32 | std::max(a, b), 3 * i + k});
      }
    }
    uses_ = in_order(uses, vertices.size());
    for (std::size_t i = 0; i < uses_.size(); ++i) {
      if (i == 0 || uses_[i].vertices != uses_[i - 1].vertices) starts_.push_back(i);
      group_[uses_[i].place] = starts_.size() - 1;
    }
    starts_.push_back(uses_.size());
  }

  std::size_t groups() const { return starts_.size() - 1; }
  std::size_t group_of(std::size_t triangle, std::size_t edge) const { return group_[3 * triangle + edge]; }

  template <class Visitor>  // (triangle) -> void
  void for_each_triangle(std::size_t group, Visitor&& visit) const {
    for (std::size_t i = starts_[group]; i < starts_[group + 1]; ++i) visit(uses_[i].place / 3);
  }

 private:
  struct Use {
    std::uint64_t vertices;  ///< numbers of both vertices, the lower number in the upper 32 bits
    std::size_t place;       ///< 3 * triangle + edge
  };

  /// Sorts by vertices, then by place: first a counting sort by the lower vertex, then a sort of the few
  /// edges of each vertex. Sorting all at once took 0.3 of the 3.4 s in which a million triangles are loaded.
  static std::vector<Use> in_order(const std::vector<Use>& uses, std::size_t vertices) {
    std::vector<std::size_t> end(vertices + 1);
    for (const Use& use : uses) ++end[(use.vertices >> 32) + 1];
    std::partial_sum(end.begin(), end.end(), end.begin());
    std::vector<Use> ordered(uses.size());
    for (const Use& use : uses) ordered[end[use.vertices >> 32]++] = use;
    std::size_t start = 0;
    for (std::size_t vertex = 0; vertex < vertices; ++vertex) {
      std::sort(ordered.begin() + std::ptrdiff_t(start), ordered.begin() + std::ptrdiff_t(end[vertex]),
                [](const Use& a, const Use& b) {
                  return a.vertices < b.vertices || (a.vertices == b.vertices && a.place < b.place);
                });
      start = end[vertex];
    }
    return ordered;
  }

  std::vector<Use> uses_;
  std::vector<std::size_t> starts_;
  std::vector<std::size_t> group_;
};

/// Whether `other` lies in the plane of `triangle`, whose unit normal is given, with a tolerance for rounding
/// of 2^-40 of the distances involved.
bool lies_in_plane(const Triangle& triangle, const glm::dvec3& normal, const Triangle& other) {
  constexpr double kTolerance = 0x1p-40;
  return std::all_of(std::begin(other.vertex), std::end(other.vertex), [&](const glm::dvec3& vertex) {
    const glm::dvec3 offset = vertex - triangle.vertex[0];
    return std::abs(glm::dot(offset, normal)) <= kTolerance * glm::length(offset);
  });
}

}  // namespace

glm::dvec3 area_normal(const Triangle& triangle) {
  return glm::cross(triangle.vertex[1] - triangle.vertex[0], triangle.vertex[2] - triangle.vertex[0]);
}

namespace {

/// Numbers what shared edges connect.
std::vector<std::int32_t> number_by_edges(const std::vector<Triangle>& triangles) {
  const Edges edges(triangles);
  std::vector<std::int32_t> faces(triangles.size(), path_tracer::kNoFace);
  std::vector<std::int32_t> searched_for(edges.groups(), path_tracer::kNoFace);
  std::int32_t next_face = 0;
  std::vector<std::size_t> open;
  for (std::size_t seed = 0; seed < triangles.size(); ++seed) {
    if (faces[seed] != path_tracer::kNoFace) continue;
    const glm::dvec3 normal = glm::normalize(area_normal(triangles[seed]));
    faces[seed] = next_face;
    open.assign(1, seed);
    while (!open.empty()) {
      const std::size_t current = open.back();
      open.pop_back();
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t group = edges.group_of(current, k);
        if (searched_for[group] == next_face) continue;
        searched_for[group] = next_face;
        edges.for_each_triangle(group, [&](std::size_t neighbour) {
          if (faces[neighbour] != path_tracer::kNoFace ||
              !lies_in_plane(triangles[seed], normal, triangles[neighbour]))
            return;
          faces[neighbour] = next_face;
          open.push_back(neighbour);
        });
      }
    }
    ++next_face;
  }
  return faces;
}

/// Gives all faces with triangles of one group the lowest of their numbers.
void join_by_groups(const CoincidentTriangles& coincident, std::vector<std::int32_t>& faces) {
  std::vector<std::int32_t> joined(faces.size());
  std::iota(joined.begin(), joined.end(), std::int32_t{0});
  const auto lowest = [&joined](std::int32_t face) {
    while (joined[std::size_t(face)] != face)
      face = joined[std::size_t(face)] = joined[std::size_t(joined[std::size_t(face)])];
    return face;
  };
  std::vector<std::int32_t> face_of_group(std::size_t(coincident.groups), path_tracer::kNoFace);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (coincident.group[i] == kNoGroup) continue;
    std::int32_t& of_group = face_of_group[std::size_t(coincident.group[i])];
    if (of_group == path_tracer::kNoFace) of_group = faces[i];
    const std::int32_t a = lowest(of_group);
    const std::int32_t b = lowest(faces[i]);
    joined[std::size_t(std::max(a, b))] = std::min(a, b);
  }
  for (std::int32_t& face : faces) face = lowest(face);
}

}  // namespace

std::vector<std::int32_t> number_faces(const std::vector<Triangle>& triangles,
                                       const CoincidentTriangles& coincident) {
  std::vector<std::int32_t> faces = number_by_edges(triangles);
  if (coincident.groups > 0) join_by_groups(coincident, faces);
  return faces;
}

std::vector<std::int32_t> number_faces(const std::vector<Triangle>& triangles) {
  return number_faces(triangles, find_coincident_triangles(triangles));
}

}  // namespace testbench
