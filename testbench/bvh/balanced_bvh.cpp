#include "testbench/bvh/balanced_bvh.hpp"

#include <algorithm>
#include <numeric>

namespace testbench {
namespace {

class Builder {
 public:
  Builder(const std::vector<Box>& boxes, int width, int max_leaf_triangles)
      : boxes_(boxes), max_leaf_triangles_(max_leaf_triangles) {
    bvh_.width = width;
    bvh_.triangles.resize(boxes.size());
    std::iota(bvh_.triangles.begin(), bvh_.triangles.end(), 0);
  }

  Bvh build() && {
    if (!boxes_.empty()) add_node({0, static_cast<std::int32_t>(boxes_.size())});
    return std::move(bvh_);
  }

 private:
  struct Range {  ///< of indices into Bvh::triangles
    std::int32_t first;
    std::int32_t count;
  };

  std::int32_t add_node(const Range& range) {
    const std::size_t index = bvh_.nodes.size();
    bvh_.nodes.emplace_back();
    std::vector<Range> parts;
    split(range, bvh_.width, parts);
    bvh_.nodes[index].child_count = static_cast<int>(parts.size());
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const BvhChild child = make_child(parts[i]);  // may move bvh_.nodes
      bvh_.nodes[index].child[i] = child;
    }
    return static_cast<std::int32_t>(index);
  }

  BvhChild make_child(const Range& range) {
    BvhChild child;
    if (range.count > max_leaf_triangles_) {
      child.node = add_node(range);
      child.box = bvh_.nodes[std::size_t(child.node)].box();
      return child;
    }
    child.first_triangle = range.first;
    child.triangle_count = range.count;
    const auto first = bvh_.triangles.begin() + range.first;
    std::sort(first, first + range.count);
    for (std::int32_t i = 0; i < range.count; ++i) child.box.include(boxes_[std::size_t(first[i])]);
    return child;
  }

  /// Splits a range into `ways` parts, or into fewer where parts are small enough to be leaves.
  void split(const Range& range, int ways, std::vector<Range>& parts) {
    if (ways == 1 || range.count <= max_leaf_triangles_) {
      parts.push_back(range);
      return;
    }
    const auto left_share = static_cast<std::int64_t>(range.count) * (ways / 2) / ways;
    const std::int32_t left = std::max(1, static_cast<std::int32_t>(left_share));
    put_in_order(range, left);
    split({range.first, left}, ways / 2, parts);
    split({range.first + left, range.count - left}, ways - ways / 2, parts);
  }

  /// Moves the `left` triangles with the lowest centres along the longest axis to the front of the range.
  void put_in_order(const Range& range, std::int32_t left) {
    const auto first = bvh_.triangles.begin() + range.first;
    Box centres;
    for (std::int32_t i = 0; i < range.count; ++i) centres.include(centre(first[i]));
    const glm::dvec3 size = 0.5 * centres.upper - 0.5 * centres.lower;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    std::nth_element(first, first + left, first + range.count, [&](std::int32_t a, std::int32_t b) {
      const double at_a = centre(a)[axis];
      const double at_b = centre(b)[axis];
      return at_a != at_b ? at_a < at_b : a < b;
    });
  }

  glm::dvec3 centre(std::int32_t triangle) const {
    const Box& box = boxes_[std::size_t(triangle)];
    return 0.5 * box.lower + 0.5 * box.upper;
  }

  const std::vector<Box>& boxes_;
  int max_leaf_triangles_;
  Bvh bvh_;
};

}  // namespace

Bvh build_balanced_bvh(const std::vector<Box>& boxes, int width, int max_leaf_triangles) {
  return Builder(boxes, width, max_leaf_triangles).build();
}

}  // namespace testbench
