#include "firmware/path_tracer/prefilter/search_tree.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <utility>

#include "firmware/path_tracer/geometry/triangle_record.hpp"
#include "firmware/path_tracer/prefilter/prefilter.hpp"
#include "firmware/path_tracer/records/node_layout.hpp"

namespace path_tracer {
namespace {

struct FloatBox {
  std::array<float, 3> lower;
  std::array<float, 3> upper;

  static FloatBox nothing() {
    constexpr float kInfinite = std::numeric_limits<float>::infinity();
    return {{kInfinite, kInfinite, kInfinite}, {-kInfinite, -kInfinite, -kInfinite}};
  }
  void include(const FloatBox& box) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      lower[axis] = std::min(lower[axis], box.lower[axis]);
      upper[axis] = std::max(upper[axis], box.upper[axis]);
    }
  }
  float centre(std::size_t axis) const { return 0.5f * (lower[axis] + upper[axis]); }
  double half_area() const {
    const double x = double(upper[0]) - lower[0];
    const double y = double(upper[1]) - lower[1];
    const double z = double(upper[2]) - lower[2];
    return x * y + y * z + z * x;
  }
};

/// Undoes the power of two that scales a record's edges: edge2 x edge1 has its square, `back`, times the
/// area's ratio in a layered scene, has it once.
double inverse_scale_of(const TriangleRecord& triangle, bool is_layered) {
  const double squared =
      dot(triangle.back, triangle.back) * (is_layered ? layered(triangle).area_ratio : 1.0);
  const double ratio = dot(cross(triangle.edge2, triangle.edge1), triangle.back) / squared;
  if (!(ratio > 0) || !std::isfinite(ratio)) return 1.0;
  return std::ldexp(1.0, -std::ilogb(ratio * std::sqrt(2.0)));
}

/// The padded box in units from the anchor, rounded outwards. Rays' origins are off by 2^-23 units at most
/// (tree_walk.hpp), which the boxes include.
FloatBox box_of(const TriangleRecord& triangle, double reach, bool is_layered, const SearchTree& tree) {
  constexpr double kRoundingOfOrigins = 0x1p-21;
  const double inverse_scale = inverse_scale_of(triangle, is_layered);
  const PaddedBox<double> box =
      padded_box(triangle.vertex, triangle.edge1 * inverse_scale, triangle.edge2 * inverse_scale, reach);
  const vec3<double> lower = (box.lower - tree.anchor) * tree.unit;
  const vec3<double> upper = (box.upper - tree.anchor) * tree.unit;
  const auto below = [](double value) { return float(value - kRoundingOfOrigins); };
  const auto above = [](double value) { return float(value + kRoundingOfOrigins); };
  return {{below(lower.x), below(lower.y), below(lower.z)}, {above(upper.x), above(upper.y), above(upper.z)}};
}

/// A node whose boxes no ray meets: the sides are the wrong way round.
SearchNode childless_node() {
  constexpr float kInfinite = std::numeric_limits<float>::infinity();
  SearchNode node{};
  for (auto& lower : node.plane[0]) std::fill(std::begin(lower), std::end(lower), kInfinite);
  for (auto& upper : node.plane[1]) std::fill(std::begin(upper), std::end(upper), -kInfinite);
  return node;
}

/// Makes leaves, and large triangles, of a scene's triangles.
class LeafMaker {
 public:
  LeafMaker(const SearchTree& tree, const TriangleRecord* first, const Layers& layers)
      : tree_(tree), first_(first), layers_(layers) {}

  /// @param count at most SearchLeaf::kTriangles
  SearchLeaf leaf(const std::int32_t* indices, int count) const {
    SearchLeaf leaf{};
    leaf.count = count;
    for (int i = 0; i < count; ++i) put(leaf, i, indices[i]);
    return leaf;
  }

  LargeTriangle large(std::int32_t index) const {
    const TriangleRecord& record = record_of(index);
    return {prefilter_triangle(record, layers_, tree_.anchor, tree_.unit), certain_determinant(record),
            index};
  }

 private:
  void put(SearchLeaf& leaf, int place, std::int32_t index) const {
    const TriangleRecord& record = record_of(index);
    const PrefilterTriangle triangle = prefilter_triangle(record, layers_, tree_.anchor, tree_.unit);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      leaf.vertex[axis][place] = triangle.vertex[axis];
      leaf.minus_edge1[axis][place] = triangle.minus_edge1[axis];
      leaf.edge2[axis][place] = triangle.edge2[axis];
      leaf.back[axis][place] = triangle.back[axis];
    }
    leaf.certain_determinant[place] = certain_determinant(record);
    leaf.face[place] = triangle.face;
    leaf.index[place] = index;
  }

  /// In a layered scene distances come from planes that triangles share, so no crossing is called certain.
  float certain_determinant(const TriangleRecord& record) const {
    return layers_.any ? std::numeric_limits<float>::infinity() : float(prefilter_scale(record, tree_.unit));
  }
  const TriangleRecord& record_of(std::int32_t index) const {
    return triangle_at(first_, index, layers_.record_bytes());
  }

  const SearchTree& tree_;
  const TriangleRecord* first_;
  const Layers& layers_;
};

/// Consecutive triangles in the order of leaves.
struct Range {
  int first;
  int count;
  FloatBox box;
};

/// Splits ranges by the surface area heuristic, in bins (Wald, "On fast Construction of SAH-based Bounding
/// Volume Hierarchies", RT 2007).
class TreeBuilder {
 public:
  TreeBuilder(SearchTree& tree, const std::vector<FloatBox>& boxes, const LeafMaker& leaves)
      : tree_(tree), boxes_(boxes), leaves_(leaves) {}

  /// @param triangles indices of those that the tree is of
  void build(std::vector<std::int32_t> triangles) {
    order_ = std::move(triangles);
    add_node();
    if (!order_.empty()) fill_node(0, range(0, static_cast<int>(order_.size())), 1);
  }

 private:
  const FloatBox& box(int place) const { return boxes_[std::size_t(order_[std::size_t(place)])]; }

  Range range(int first, int count) const {
    Range result{first, count, FloatBox::nothing()};
    for (int i = 0; i < count; ++i) result.box.include(box(first + i));
    return result;
  }

  /// The range that costs most is split until there are as many as a node has children.
  void fill_node(std::size_t number, const Range& all, int level) {
    std::vector<Range> children = {all};
    const bool is_deep = level > SearchTree::kMostLevels / 2;
    while (children.size() < SearchNode::kChildren) {
      const auto cost = [](const Range& of) {
        return of.count > SearchLeaf::kTriangles ? of.box.half_area() * of.count + 1e-30 * of.count : -1.0;
      };
      const auto widest = std::max_element(children.begin(), children.end(),
                                           [&](const Range& a, const Range& b) { return cost(a) < cost(b); });
      if (widest->count <= SearchLeaf::kTriangles) break;
      const Range whole = *widest;
      const int left = is_deep ? split_in_middle(whole) : split_by_area(whole);
      *widest = range(whole.first, left);
      children.push_back(range(whole.first + left, whole.count - left));
    }
    for (std::size_t i = 0; i < children.size(); ++i) put_child(number, i, children[i], level);
  }

  std::size_t add_node() {
    tree_.nodes.push_back(childless_node());
    return tree_.nodes.size() - 1;
  }

  void put_child(std::size_t number, std::size_t place, const Range& child, int level) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      tree_.nodes[number].plane[0][axis][place] = child.box.lower[axis];
      tree_.nodes[number].plane[1][axis][place] = child.box.upper[axis];
    }
    if (child.count <= SearchLeaf::kTriangles) {
      const std::uint32_t leaf = SearchTree::kFirstLeaf + static_cast<std::uint32_t>(tree_.leaves.size());
      tree_.nodes[number].child[place] = leaf;
      tree_.leaves.push_back(leaves_.leaf(order_.data() + child.first, child.count));
      return;
    }
    const std::size_t next = add_node();
    tree_.nodes[number].child[place] = static_cast<std::uint32_t>(next);
    fill_node(next, child, level + 1);
  }

  std::size_t widest_axis(const Range& whole, float& low, float& high) const {
    FloatBox centres = FloatBox::nothing();
    for (int i = 0; i < whole.count; ++i)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const float centre = box(whole.first + i).centre(axis);
        centres.lower[axis] = std::min(centres.lower[axis], centre);
        centres.upper[axis] = std::max(centres.upper[axis], centre);
      }
    std::size_t widest = 0;
    for (std::size_t axis = 1; axis < 3; ++axis)
      if (centres.upper[axis] - centres.lower[axis] > centres.upper[widest] - centres.lower[widest])
        widest = axis;
    low = centres.lower[widest];
    high = centres.upper[widest];
    return widest;
  }

  /// @return how many triangles come into the left part, at least one and not all
  int split_in_middle(const Range& whole) {
    float low = 0;
    float high = 0;
    const std::size_t axis = widest_axis(whole, low, high);
    const auto begin = order_.begin() + whole.first;
    std::nth_element(begin, begin + whole.count / 2, begin + whole.count, [&](int a, int b) {
      const float centre_a = boxes_[std::size_t(a)].centre(axis);
      const float centre_b = boxes_[std::size_t(b)].centre(axis);
      return centre_a < centre_b || (centre_a == centre_b && a < b);
    });
    return whole.count / 2;
  }

  int split_by_area(const Range& whole) {
    constexpr int kBins = 16;
    float low = 0;
    float high = 0;
    const std::size_t axis = widest_axis(whole, low, high);
    if (!(high > low)) return split_in_middle(whole);
    const float scale = kBins / (high - low);
    const auto bin_of = [&](int triangle) {
      return std::clamp(static_cast<int>((boxes_[std::size_t(triangle)].centre(axis) - low) * scale), 0,
                        kBins - 1);
    };
    std::array<FloatBox, kBins> bins;
    bins.fill(FloatBox::nothing());
    std::array<int, kBins> counts{};
    for (int i = 0; i < whole.count; ++i) {
      const auto bin = std::size_t(bin_of(order_[std::size_t(whole.first + i)]));
      bins[bin].include(box(whole.first + i));
      ++counts[bin];
    }
    std::array<double, kBins> right_cost{};
    FloatBox right = FloatBox::nothing();
    int right_count = 0;
    for (std::size_t bin = kBins - 1; bin > 0; --bin) {
      right.include(bins[bin]);
      right_count += counts[bin];
      right_cost[bin] = right_count > 0 ? right.half_area() * right_count : 0.0;
    }
    int best = -1;
    double least = std::numeric_limits<double>::infinity();
    FloatBox left = FloatBox::nothing();
    int left_count = 0;
    for (int bin = 0; bin + 1 < kBins; ++bin) {
      left.include(bins[std::size_t(bin)]);
      left_count += counts[std::size_t(bin)];
      if (left_count == 0 || left_count == whole.count) continue;
      const double cost = left.half_area() * left_count + right_cost[std::size_t(bin) + 1];
      if (cost < least) {
        least = cost;
        best = bin;
      }
    }
    if (best < 0) return split_in_middle(whole);
    const auto begin = order_.begin() + whole.first;
    const auto middle =
        std::partition(begin, begin + whole.count, [&](int triangle) { return bin_of(triangle) <= best; });
    return static_cast<int>(middle - begin);
  }

  SearchTree& tree_;
  const std::vector<FloatBox>& boxes_;
  const LeafMaker& leaves_;
  std::vector<std::int32_t> order_;
};

/// Takes the largest triangles out, if most rays meet their boxes. Returns the indices of the others.
std::vector<std::int32_t> take_large(SearchTree& tree, const LeafMaker& leaves,
                                     const std::vector<FloatBox>& boxes) {
  constexpr double kLargePart = 1.0 / 20;  // of the area of a box around all
  FloatBox all = FloatBox::nothing();
  for (const FloatBox& box : boxes) all.include(box);
  std::vector<std::int32_t> large;
  std::vector<std::int32_t> others;
  const auto area = [&](std::int32_t i) { return boxes[std::size_t(i)].half_area(); };
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(boxes.size()); ++i)
    (area(i) >= kLargePart * all.half_area() ? large : others).push_back(i);
  std::stable_sort(large.begin(), large.end(), [&](auto a, auto b) { return area(a) > area(b); });
  const std::size_t kept = std::min(large.size(), std::size_t{SearchTree::kMostLarge});
  others.insert(others.end(), large.begin() + std::ptrdiff_t(kept), large.end());
  large.resize(kept);
  for (const std::int32_t index : large) tree.large.push_back(leaves.large(index));
  return others;
}

/// Writes a leaf for the face of each light, beside those of the tree.
void add_light_leaves(SearchTree& tree, const LeafMaker& leaves, const std::vector<std::int32_t>& faces,
                      const LightRecord* lights, int light_count) {
  std::map<std::int32_t, std::vector<std::int32_t>> of_face;
  for (int i = 0; i < light_count; ++i)
    if (lights[i].face >= 0) of_face[lights[i].face];
  if (of_face.empty()) return;
  for (std::size_t i = 0; i < faces.size(); ++i)
    if (const auto found = of_face.find(faces[i]); found != of_face.end())
      found->second.push_back(static_cast<std::int32_t>(i));
  tree.light_leaf.resize(std::size_t(of_face.rbegin()->first) + 1, SearchTree::kNoLeaf);
  for (const auto& [face, triangles] : of_face) {
    if (triangles.size() > SearchLeaf::kTriangles) continue;
    tree.light_leaf[std::size_t(face)] = static_cast<std::int32_t>(tree.leaves.size());
    tree.leaves.push_back(leaves.leaf(triangles.data(), static_cast<int>(triangles.size())));
  }
}

}  // namespace

SearchTree make_search_tree(const TriangleRecord* first, int count, double reach, const Layers& layers,
                            const LightRecord* lights, int light_count) {
  SearchTree tree;
  if (count == 0) return tree;
  tree.anchor = first->vertex;
  tree.unit = to_node_unit(NodeFormat::fp32, reach);
  std::vector<FloatBox> boxes;
  std::vector<std::int32_t> faces;
  boxes.reserve(std::size_t(count));
  faces.reserve(std::size_t(count));
  for (int i = 0; i < count; ++i) {
    const TriangleRecord& triangle = triangle_at(first, i, layers.record_bytes());
    boxes.push_back(box_of(triangle, reach, layers.any, tree));
    faces.push_back(triangle.face);
  }
  const LeafMaker leaves(tree, first, layers);
  TreeBuilder(tree, boxes, leaves).build(take_large(tree, leaves, boxes));
  add_light_leaves(tree, leaves, faces, lights, light_count);
  return tree;
}

}  // namespace path_tracer
