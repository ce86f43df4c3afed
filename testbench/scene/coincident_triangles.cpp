#include "testbench/scene/coincident_triangles.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "testbench/scene/triangle_overlap.hpp"

namespace testbench {
namespace {

/// A triangle in a cell of the space of planes. A plane is told by the slopes of its normal, relative to its
/// largest component, and by where it crosses that component's axis.
struct PlaneEntry {
  std::uint64_t cell;
  std::uint32_t triangle;

  bool operator<(const PlaneEntry& other) const {
    return cell != other.cell ? cell < other.cell : triangle < other.triangle;
  }
};

/// The axis of a cell, which is that of its planes' largest components (for_each_cell()).
int axis_of(std::uint64_t cell) {
  return int(cell >> 48);
}

/// Cells that a number lies in: its own and, near the upper border, the next one. So two numbers that differ
/// by at most that share of a cell have a cell in common.
class Cells {
 public:
  Cells(double number, double near_border) {
    constexpr double kCellsOfOne = 0x1p10;
    constexpr double kMost = 4.0;
    const double at = (number + kMost) * kCellsOfOne;
    const double first = std::floor(at);
    first_ = std::uint64_t(first);
    last_ = at - first > 1.0 - near_border ? first_ + 1 : first_;
  }
  std::uint64_t first() const { return first_; }
  std::uint64_t last() const { return last_; }

 private:
  std::uint64_t first_;
  std::uint64_t last_;
};

/// Calls visit(cell) for the cells of a triangle's plane. Triangles within plane_tolerance() of a plane that
/// are higher than 2^-30 of the scene's reach differ by less than 2^-14 in each slope, and so by less than
/// 2^-13 in the crossing: they have a cell in common.
template <class Visitor>
void for_each_cell(const Triangle& triangle, const glm::dvec3& anchor, double extent, Visitor&& visit) {
  const glm::dvec3 edge1 = (triangle.vertex[1] - triangle.vertex[0]) / extent;
  const glm::dvec3 edge2 = (triangle.vertex[2] - triangle.vertex[0]) / extent;
  const glm::dvec3 at = (triangle.vertex[0] - anchor) / extent;
  const glm::dvec3 normal = glm::cross(edge1, edge2);
  const glm::dvec3 size = glm::abs(normal);
  const double largest = std::max({size.x, size.y, size.z});
  for (int axis = 0; axis < 3; ++axis) {
    if (size[axis] < largest * (1.0 - 0x1p-12)) continue;
    const int second = (axis + 1) % 3;
    const int third = (axis + 2) % 3;
    const double slope2 = normal[second] / normal[axis];
    const double slope3 = normal[third] / normal[axis];
    const Cells cells2(slope2, 1.0 / 16);
    const Cells cells3(slope3, 1.0 / 16);
    const Cells crossings(at[axis] + slope2 * at[second] + slope3 * at[third], 1.0 / 8);
    for (std::uint64_t i = cells2.first(); i <= cells2.last(); ++i)
      for (std::uint64_t j = cells3.first(); j <= cells3.last(); ++j)
        for (std::uint64_t k = crossings.first(); k <= crossings.last(); ++k)
          visit(((std::uint64_t(axis) << 16 | i) << 16 | j) << 16 | k);
  }
}

/// The entries of all triangles that are not too thin, cell by cell: first by a number of few bits that the
/// cell has, then by the cell. That takes half as long as to sort them all.
std::vector<PlaneEntry> entries_by_cell(const std::vector<Triangle>& triangles, const SceneSize& size) {
  constexpr int kBits = 20;
  const auto place_of = [](std::uint64_t cell) { return (cell * 0x9e3779b97f4a7c15u) >> (64 - kBits); };
  const glm::dvec3 anchor = triangles[0].vertex[0];
  std::vector<PlaneEntry> entries;
  entries.reserve(triangles.size() + triangles.size() / 2);
  std::vector<std::uint32_t> end((std::size_t{1} << kBits) + 1);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (!(height_of(triangles[i]) >= size.least_height())) continue;
    for_each_cell(triangles[i], anchor, size.extent, [&](std::uint64_t cell) {
      entries.push_back({cell, std::uint32_t(i)});
      ++end[place_of(cell) + 1];
    });
  }
  std::partial_sum(end.begin(), end.end(), end.begin());
  std::vector<PlaneEntry> ordered(entries.size());
  for (const PlaneEntry& entry : entries) ordered[end[place_of(entry.cell)]++] = entry;
  std::size_t first = 0;
  for (std::size_t place = 0; place + 1 < end.size(); ++place) {
    if (end[place] - first > 1)
      std::sort(ordered.begin() + std::ptrdiff_t(first), ordered.begin() + std::ptrdiff_t(end[place]));
    first = end[place];
  }
  return ordered;
}

/// Sets of triangles that are joined one to another.
class JoinedSets {
 public:
  explicit JoinedSets(std::size_t triangles) : parent_(triangles) {
    std::iota(parent_.begin(), parent_.end(), std::uint32_t{0});
  }
  std::uint32_t first_of(std::uint32_t triangle) {
    while (parent_[triangle] != triangle) triangle = parent_[triangle] = parent_[parent_[triangle]];
    return triangle;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = first_of(a);
    b = first_of(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

struct CornerBox {
  glm::dvec3 lower;
  glm::dvec3 upper;

  explicit CornerBox(const Triangle& triangle)
      : lower(glm::min(glm::min(triangle.vertex[0], triangle.vertex[1]), triangle.vertex[2])),
        upper(glm::max(glm::max(triangle.vertex[0], triangle.vertex[1]), triangle.vertex[2])) {}
  void include(const CornerBox& other) {
    lower = glm::min(lower, other.lower);
    upper = glm::max(upper, other.upper);
  }
  bool meets(const CornerBox& other, double margin) const {
    return glm::all(glm::lessThanEqual(lower, other.upper + margin)) &&
           glm::all(glm::lessThanEqual(other.lower, upper + margin));
  }
};

/// A tree of boxes over the triangles of a cell, from which triangles are taken as they are met. Each is met
/// once, so that a thousand triangles on one another take no million steps.
class OverlapTree {
 public:
  OverlapTree(const std::vector<Triangle>& all, const PlaneEntry* first, std::size_t count,
              const SceneSize& size)
      : all_(all), size_(size) {
    std::vector<Centre> centres;
    centres.reserve(count);
    for (std::size_t i = 0; i < count; ++i)
      centres.emplace_back(all[first[i].triangle], first[i].triangle, all[0].vertex[0], size.extent);
    items_.reserve(count);
    nodes_.reserve(2 * count);
    build(axis_of(first->cell), centres, 0, count);
  }

  /// Joins all that are connected by overlaps.
  void join_all(JoinedSets& sets) {
    std::vector<const Item*> open;
    while (nodes_[0].left_in > 0) {
      open.assign(1, &take_any(0));
      while (!open.empty()) {
        const Item& current = *open.back();
        open.pop_back();
        const std::size_t old = open.size();
        take_met(0, current, open);
        for (std::size_t i = old; i < open.size(); ++i) sets.join(current.triangle, open[i]->triangle);
      }
    }
  }

 private:
  static constexpr std::size_t kMostInLeaf = 4;
  struct Item {
    std::uint32_t triangle;
    CornerBox bounds;
    Silhouette silhouette;
    bool is_taken = false;
  };
  struct Node {
    CornerBox bounds;
    std::size_t first;
    std::size_t end;
    std::size_t left_in;     ///< items that are not taken
    std::size_t second = 0;  ///< the second child; the first one follows its parent. 0 for a leaf
  };

  /// Where a triangle is, in a few bytes that are moved fast.
  struct Centre {
    std::array<float, 3> at;
    std::uint32_t triangle;

    Centre(const Triangle& of, std::uint32_t number, const glm::dvec3& origin, double extent)
        : triangle(number) {
      const glm::dvec3 sum =
          ((of.vertex[0] - origin) + (of.vertex[1] - origin) + (of.vertex[2] - origin)) / extent;
      at = {float(sum.x), float(sum.y), float(sum.z)};
    }
  };

  /// Splits the centres in half along the axis in which they extend farthest. @return the node's place
  std::size_t build(int axis, std::vector<Centre>& centres, std::size_t first, std::size_t end) {
    const std::size_t place = nodes_.size();
    nodes_.push_back({CornerBox(all_[centres[first].triangle]), first, end, end - first});
    if (end - first <= kMostInLeaf) {
      for (std::size_t i = first; i < end; ++i) {
        const Triangle& triangle = all_[centres[i].triangle];
        items_.push_back(
            {centres[i].triangle, CornerBox(triangle), seen_along(axis, triangle, all_[0].vertex[0])});
        nodes_[place].bounds.include(items_.back().bounds);
      }
      return place;
    }
    const std::size_t longest = longest_axis(centres, first, end);
    const std::size_t middle = first + (end - first) / 2;
    const auto at = [&](std::size_t i) { return centres.begin() + std::ptrdiff_t(i); };
    std::nth_element(at(first), at(middle), at(end),
                     [longest](const Centre& a, const Centre& b) { return a.at[longest] < b.at[longest]; });
    build(axis, centres, first, middle);
    const std::size_t second = build(axis, centres, middle, end);
    nodes_[place].second = second;
    nodes_[place].bounds.include(nodes_[place + 1].bounds);
    nodes_[place].bounds.include(nodes_[second].bounds);
    return place;
  }

  static std::size_t longest_axis(const std::vector<Centre>& centres, std::size_t first, std::size_t end) {
    std::array<float, 3> lower = centres[first].at;
    std::array<float, 3> upper = lower;
    for (std::size_t i = first + 1; i < end; ++i)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        lower[axis] = std::min(lower[axis], centres[i].at[axis]);
        upper[axis] = std::max(upper[axis], centres[i].at[axis]);
      }
    std::size_t longest = 0;
    for (std::size_t axis = 1; axis < 3; ++axis)
      if (upper[axis] - lower[axis] > upper[longest] - lower[longest]) longest = axis;
    return longest;
  }

  const Item& take_any(std::size_t place) {
    Node& node = nodes_[place];
    --node.left_in;
    if (node.second != 0) return take_any(nodes_[place + 1].left_in > 0 ? place + 1 : node.second);
    std::size_t i = node.first;
    while (items_[i].is_taken) ++i;
    items_[i].is_taken = true;
    return items_[i];
  }

  /// @return the number of triangles taken
  std::size_t take_met(std::size_t place, const Item& current, std::vector<const Item*>& met) {
    Node& node = nodes_[place];
    if (node.left_in == 0 || !node.bounds.meets(current.bounds, size_.plane_tolerance())) return 0;
    std::size_t taken = 0;
    if (node.second != 0) {
      taken = take_met(place + 1, current, met) + take_met(node.second, current, met);
    } else {
      for (std::size_t i = node.first; i < node.end; ++i) {
        Item& item = items_[i];
        if (item.is_taken || !item.bounds.meets(current.bounds, size_.plane_tolerance()) ||
            !overlap(item.silhouette, current.silhouette, size_) ||
            !lie_in_one_plane(all_[item.triangle], all_[current.triangle], size_))
          continue;
        item.is_taken = true;
        met.push_back(&item);
        ++taken;
      }
    }
    node.left_in -= taken;
    return taken;
  }

  const std::vector<Triangle>& all_;
  const SceneSize& size_;
  std::vector<Item> items_;
  std::vector<Node> nodes_;
};

/// Joins two triangles, which are alone in their cell, if they coincide: the most frequent case by far.
void join_pair(const std::vector<Triangle>& triangles, const PlaneEntry& a, const PlaneEntry& b,
               const SceneSize& size, JoinedSets& sets) {
  const Triangle& first = triangles[a.triangle];
  const Triangle& second = triangles[b.triangle];
  const int axis = axis_of(a.cell);
  const glm::dvec3& origin = triangles[0].vertex[0];
  if (overlap(seen_along(axis, first, origin), seen_along(axis, second, origin), size) &&
      lie_in_one_plane(first, second, size))
    sets.join(a.triangle, b.triangle);
}

/// Numbers the sets of several triangles in the order of their first ones.
CoincidentTriangles numbered(JoinedSets& sets, std::size_t triangles) {
  CoincidentTriangles result;
  result.group.assign(triangles, kNoGroup);
  std::vector<bool> has_others(triangles);
  for (std::uint32_t i = 0; i < triangles; ++i)
    if (sets.first_of(i) != i) has_others[sets.first_of(i)] = true;
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const std::uint32_t first = sets.first_of(i);
    if (!has_others[first]) continue;
    result.group[i] = first == i ? result.groups++ : result.group[first];
    ++result.triangles;
  }
  return result;
}

CoincidentTriangles find_coincident(const std::vector<Triangle>& triangles, double rounded_at) {
  JoinedSets sets(triangles.size());
  if (triangles.size() < 2) return numbered(sets, triangles.size());
  const SceneSize size = size_of(triangles, rounded_at);
  const std::vector<PlaneEntry> entries = entries_by_cell(triangles, size);
  for (std::size_t first = 0, end; first < entries.size(); first = end) {
    end = first + 1;
    while (end < entries.size() && entries[end].cell == entries[first].cell) ++end;
    if (end - first == 2) {
      join_pair(triangles, entries[first], entries[first + 1], size, sets);
    } else if (end - first > 2) {
      OverlapTree(triangles, &entries[first], end - first, size).join_all(sets);
    }
  }
  return numbered(sets, triangles.size());
}

}  // namespace

CoincidentTriangles find_coincident_triangles(const Scene& scene) {
  return find_coincident(scene.triangles, scene.rounded_at);
}

CoincidentTriangles find_coincident_triangles(const std::vector<Triangle>& triangles) {
  return find_coincident(triangles, 0.0);
}

void order_coincident_triangles(Scene& scene, const std::string& file) {
  const CoincidentTriangles found = find_coincident_triangles(scene);
  scene.coincident_triangles = found.triangles;
  if (found.triangles == 0) return;
  scene.notes.add(
      "a triangle lies on another one in its plane: what faces the ray is seen, lights first, then what "
      "is listed first",
      file, found.triangles);
  std::vector<std::size_t> order(scene.triangles.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_partition(order.begin(), order.end(), [&](std::size_t triangle) {
    return scene.materials[std::size_t(scene.triangles[triangle].material)].emission != glm::dvec3(0.0);
  });
  const std::vector<Triangle> listed = scene.triangles;
  for (std::size_t i = 0; i < order.size(); ++i) scene.triangles[i] = listed[order[i]];
  reorder_corner_attributes(scene.corners, order);
}

}  // namespace testbench
