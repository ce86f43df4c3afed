#include "testbench/bvh/tree_image.hpp"

#include <string>

#include "testbench/bvh/build_bvh.hpp"
#include "testbench/bvh/treelets.hpp"
#include "testbench/system/error.hpp"

namespace testbench {

TreeImage make_tree_image(const std::vector<Box>& boxes, const path_tracer::TreeShape& shape) {
  constexpr std::int64_t kMost = path_tracer::PackedReference::kFirstMask;
  const auto require_names = [](const std::string& what, std::int64_t found) {
    if (found > kMost)
      throw InputError("tree of boxes: " + std::to_string(found) + " " + what + ", allowed are " +
                       std::to_string(kMost));
  };
  require_names("triangles", static_cast<std::int64_t>(boxes.size()));
  BvhOptions options;
  options.width = shape.layout.width;
  options.max_leaf_triangles = shape.leaf_triangles;
  options.max_depth = path_tracer::max_tree_levels(options.width);
  Bvh bvh = build_bvh(boxes, options);
  TreeImage image;
  image.levels = levels(bvh);
  const Treelets treelets = pack_treelets(bvh, {shape.resident_nodes, shape.treelet_nodes});
  image.slots = treelets.slots();
  require_names("slots of nodes", image.slots);
  image.nodes = encode_treelets(bvh, treelets, shape.layout);
  image.triangles = std::move(bvh.triangles);
  return image;
}

}  // namespace testbench
