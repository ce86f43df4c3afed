#include "testbench/bvh/build_bvh.hpp"

#include <embree3/rtcore.h>

#include <algorithm>
#include <memory>
#include <string>

#include "firmware/path_tracer/records/node_layout.hpp"
#include "testbench/bvh/balanced_bvh.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

constexpr int kMaxLeafTriangles = path_tracer::PackedReference::kMaxCount;
static_assert(kMaxLeafTriangles <= RTC_BUILD_MAX_PRIMITIVES_PER_LEAF);
/// Embree begins to split by number 8 levels before the depth that it is given.
constexpr int kLeastMaxDepth = 16;

/// A node that Embree's callbacks write, in memory that Embree allocates.
struct Branch {
  unsigned child_count;  ///< 0 for a leaf
  Branch* child[kMaxBvhWidth];
  std::uint32_t triangle_count;
  std::uint32_t triangle[kMaxLeafTriangles];
};

void* create_node(RTCThreadLocalAllocator allocator, unsigned child_count, void*) {
  auto* const branch = static_cast<Branch*>(rtcThreadLocalAlloc(allocator, sizeof(Branch), 16));
  branch->child_count = child_count;
  return branch;
}

void set_children(void* node, void** children, unsigned child_count, void*) {
  for (unsigned i = 0; i < child_count; ++i)
    static_cast<Branch*>(node)->child[i] = static_cast<Branch*>(children[i]);
}

void ignore_bounds(void*, const RTCBounds**, unsigned, void*) {}

void* create_leaf(RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* primitives, std::size_t count,
                  void*) {
  auto* const branch = static_cast<Branch*>(rtcThreadLocalAlloc(allocator, sizeof(Branch), 16));
  branch->child_count = 0;
  branch->triangle_count = static_cast<std::uint32_t>(count);
  for (std::size_t i = 0; i < count; ++i) branch->triangle[i] = primitives[i].primID;
  return branch;
}

struct ReleaseDevice {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct ReleaseBvh {
  void operator()(RTCBVH bvh) const { rtcReleaseBVH(bvh); }
};

void check(const BvhOptions& options) {
  const auto require = [](bool allowed, const std::string& what, int found, int least, int most) {
    if (!allowed)
      throw InputError("BVH: " + what + " is " + std::to_string(found) + ", allowed are " +
                       std::to_string(least) + " to " + std::to_string(most));
  };
  require(options.width >= 2 && options.width <= kMaxBvhWidth, "width", options.width, 2, kMaxBvhWidth);
  require(options.max_leaf_triangles >= 1 && options.max_leaf_triangles <= kMaxLeafTriangles,
          "number of triangles a leaf", options.max_leaf_triangles, 1, kMaxLeafTriangles);
  require(options.max_depth >= kLeastMaxDepth && options.max_depth <= 128, "depth", options.max_depth,
          kLeastMaxDepth, 128);
}

/// The boxes for Embree, relative to the scene's box: Embree works in single precision, and so any scale of
/// the scene serves. Rounding may move a triangle across a split but never out of the tree.
std::vector<RTCBuildPrimitive> primitives_of(const std::vector<Box>& boxes) {
  Box scene;
  for (const Box& box : boxes) scene.include(box);
  // Halved before they are subtracted: the differences of the largest numbers overflow.
  const glm::dvec3 half_size = 0.5 * scene.upper - 0.5 * scene.lower;
  const double largest = std::max({half_size.x, half_size.y, half_size.z});
  const auto relative = [&](const glm::dvec3& point) {
    return largest > 0.0 ? glm::vec3((point * 0.5 - scene.lower * 0.5) / largest) : glm::vec3(0.0f);
  };
  std::vector<RTCBuildPrimitive> primitives(boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const glm::vec3 lower = relative(boxes[i].lower);
    const glm::vec3 upper = relative(boxes[i].upper);
    primitives[i] = {lower.x, lower.y, lower.z, 0, upper.x, upper.y, upper.z, static_cast<unsigned>(i)};
  }
  return primitives;
}

/// Copies Embree's tree with exact boxes, parents first.
class Copier {
 public:
  Copier(const std::vector<Box>& boxes, Bvh& bvh) : boxes_(boxes), bvh_(bvh) {}

  void copy_root(const Branch& root) {
    if (root.child_count > 0) {
      copy_node(root);
      return;
    }
    bvh_.nodes.emplace_back();  // a node whose only child is the leaf
    bvh_.nodes[0].child_count = 1;
    bvh_.nodes[0].child[0] = copy_leaf(root);
  }

 private:
  std::int32_t copy_node(const Branch& branch) {
    const std::size_t index = bvh_.nodes.size();
    bvh_.nodes.emplace_back();
    bvh_.nodes[index].child_count = static_cast<int>(branch.child_count);
    for (unsigned i = 0; i < branch.child_count; ++i) {
      const BvhChild child = copy_child(*branch.child[i]);  // may move bvh_.nodes
      bvh_.nodes[index].child[i] = child;
    }
    return static_cast<std::int32_t>(index);
  }

  BvhChild copy_child(const Branch& branch) {
    if (branch.child_count == 0) return copy_leaf(branch);
    BvhChild child;
    child.node = copy_node(branch);
    child.box = bvh_.nodes[std::size_t(child.node)].box();
    return child;
  }

  BvhChild copy_leaf(const Branch& branch) {
    BvhChild child;
    child.first_triangle = static_cast<std::int32_t>(bvh_.triangles.size());
    child.triangle_count = static_cast<std::int32_t>(branch.triangle_count);
    for (std::uint32_t i = 0; i < branch.triangle_count; ++i) {
      bvh_.triangles.push_back(static_cast<std::int32_t>(branch.triangle[i]));
      child.box.include(boxes_[branch.triangle[i]]);
    }
    std::sort(bvh_.triangles.end() - child.triangle_count, bvh_.triangles.end());
    return child;
  }

  const std::vector<Box>& boxes_;
  Bvh& bvh_;
};

/// Returns a tree without nodes if Embree gives up because the tree would be too deep, as it does for many
/// triangles in one place.
Bvh build_by_area(const std::vector<Box>& boxes, const BvhOptions& options) {
  Bvh bvh;
  bvh.width = options.width;
  std::vector<RTCBuildPrimitive> primitives = primitives_of(boxes);

  // One thread, because several would allocate and split in an order that varies from run to run.
  const std::unique_ptr<RTCDeviceTy, ReleaseDevice> device(rtcNewDevice("threads=1,user_threads=1"));
  if (!device)
    throw RunError("BVH: Embree makes no device: error " + std::to_string(rtcGetDeviceError(nullptr)));
  const std::unique_ptr<RTCBVHTy, ReleaseBvh> tree(rtcNewBVH(device.get()));
  RTCBuildArguments arguments = rtcDefaultBuildArguments();
  arguments.buildQuality = RTC_BUILD_QUALITY_MEDIUM;  // binned SAH
  arguments.maxBranchingFactor = static_cast<unsigned>(options.width);
  arguments.maxDepth = static_cast<unsigned>(options.max_depth);
  arguments.maxLeafSize = static_cast<unsigned>(options.max_leaf_triangles);
  arguments.traversalCost = static_cast<float>(options.traversal_cost);
  arguments.intersectionCost = static_cast<float>(options.intersection_cost);
  arguments.bvh = tree.get();
  arguments.primitives = primitives.data();
  arguments.primitiveCount = arguments.primitiveArrayCapacity = primitives.size();
  arguments.createNode = create_node;
  arguments.setNodeChildren = set_children;
  arguments.setNodeBounds = ignore_bounds;
  arguments.createLeaf = create_leaf;
  const auto* const root = static_cast<const Branch*>(rtcBuildBVH(&arguments));
  if (root == nullptr) return bvh;
  bvh.triangles.reserve(boxes.size());
  Copier(boxes, bvh).copy_root(*root);
  return bvh;
}

}  // namespace

Bvh build_bvh(const std::vector<Triangle>& triangles, const BvhOptions& options) {
  std::vector<Box> boxes(triangles.size());
  std::transform(triangles.begin(), triangles.end(), boxes.begin(), bounds_of);
  return build_bvh(boxes, options);
}

int levels(const Bvh& bvh) {
  std::vector<int> level(bvh.nodes.size(), 1);  // nodes precede their children
  int deepest = 0;
  for (std::size_t node = 0; node < bvh.nodes.size(); ++node) {
    deepest = std::max(deepest, level[node]);
    for (int i = 0; i < bvh.nodes[node].child_count; ++i) {
      const BvhChild& child = bvh.nodes[node].child[std::size_t(i)];
      if (!child.is_leaf()) level[std::size_t(child.node)] = level[node] + 1;
    }
  }
  return deepest;
}

Bvh build_bvh(const std::vector<Box>& boxes, const BvhOptions& options) {
  check(options);
  if (boxes.empty()) return build_balanced_bvh(boxes, options.width, options.max_leaf_triangles);
  Bvh bvh = build_by_area(boxes, options);
  if (!bvh.nodes.empty() && levels(bvh) <= options.max_depth) return bvh;
  bvh = build_balanced_bvh(boxes, options.width, options.max_leaf_triangles);
  const int least = levels(bvh);
  if (least > options.max_depth)
    throw RunError("BVH of " + std::to_string(boxes.size()) + " triangles: " + std::to_string(least) +
                   " levels at least, allowed are " + std::to_string(options.max_depth));
  return bvh;
}

double sah_cost(const Bvh& bvh, const BvhOptions& options) {
  if (bvh.nodes.empty()) return 0.0;
  const Box root = bvh.nodes[0].box();
  double cost = 0.0;
  for (const BvhNode& node : bvh.nodes)
    for (int i = 0; i < node.child_count; ++i) {
      const BvhChild& child = node.child[std::size_t(i)];
      cost += child.box.half_area() *
              (child.is_leaf() ? child.triangle_count * options.intersection_cost : options.traversal_cost);
    }
  return options.traversal_cost + cost / std::max(root.half_area(), std::numeric_limits<double>::min());
}

}  // namespace testbench
