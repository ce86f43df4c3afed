#pragma once

#include "firmware/path_tracer/geometry/nearest_face.hpp"
#include "firmware/path_tracer/kernels/traversal.hpp"
#include "firmware/path_tracer/kernels/traverse_kernels.hpp"

/// The code of traverse_2.cpp, traverse_4.cpp and traverse_8.cpp. They are separate files because each takes
/// a minute or two to compile for each x86-64 level.
namespace path_tracer {

/// One leaf per PE.
struct PolyTriangles {
  PolyPointer<TriangleRecord> first;  ///< in a layered scene of a LayeredTriangleRecord
  int count;
  bool is_in_layers;
  const poly<std::int32_t>& there;

  PolyTriangle operator()(int i) const {
    if (!is_in_layers) return triangle(first[i]);
    const PolyPointer<LayeredTriangleRecord> at =
        PolyPointer<LayeredTriangleRecord>(first.span().offset_bytes)[i];
    PolyTriangle whole = triangle(at.part(&LayeredTriangleRecord::triangle));
    whole.plane_offset.assign_all_lanes(at.get(&LayeredTriangleRecord::plane_offset));
    whole.area_ratio.assign_all_lanes(at.get(&LayeredTriangleRecord::area_ratio));
    return whole;
  }
  static PolyTriangle triangle(const PolyPointer<TriangleRecord>& at) {
    return {at.get(&TriangleRecord::vertex), at.get(&TriangleRecord::edge1), at.get(&TriangleRecord::edge2),
            at.get(&TriangleRecord::back),   at.get(&TriangleRecord::face),  at.get(&TriangleRecord::number)};
  }
  mask where_there(int i, const mask& lanes) const { return lanes & (there > i); }
};

/// Tests the leaf. A shadow ray is finished when something is nearer than its light. A shadow ray that missed
/// its light finds what else it hits, because the light's face may have other triangles.
inline void test_leaf(const TraverseArguments& arguments, const RayOperands& ray, NearestFace& nearest,
                      TraversalState& state) {
  const poly<std::int32_t> light_face = arguments.record.get(&TraversalRecord::light_face);
  nearest.face.assign_all_lanes(light_face);
  const poly<std::int32_t> there =
      cn::select(cn::recall(*arguments.loaded_leaf), state.leaf_count, poly<std::int32_t>(0));
  search(ray, arguments.reach,
         PolyTriangles{arguments.leaf, arguments.tree.shape.leaf_records(), arguments.layers.any, there},
         nearest);
  cn::poly_if(there > 0, [&] {
    const mask is_missed = nearest.number < 0;
    arguments.record.set(&TraversalRecord::light_face,
                         cn::select(is_missed, poly<std::int32_t>(kNoFace), light_face));
    const mask occluded = (light_face != poly<std::int32_t>(kNoFace)) & (nearest.face != light_face);
    state.node = cn::select(occluded & !is_missed, poly<std::int32_t>(kTraversalOver), state.node);
    state.leaf_count = 0;
  });
  arguments.record.set(&TraversalRecord::distance, nearest.distance);
  arguments.record.set(&TraversalRecord::determinant, nearest.determinant);
  arguments.record.set(&TraversalRecord::number, nearest.number);
}

template <NodeFormat format, int width>
void traverse(const TraverseArguments& arguments) {
  const RayOperands ray = ray_of(arguments.record, arguments.layers);
  NearestFace nearest;
  nearest.distance.assign_all_lanes(arguments.record.get(&TraversalRecord::distance));
  nearest.determinant.assign_all_lanes(arguments.record.get(&TraversalRecord::determinant));
  nearest.number.assign_all_lanes(arguments.record.get(&TraversalRecord::number));
  TraversalState state(arguments.record);
  if (arguments.loaded_leaf != nullptr) test_leaf(arguments, ray, nearest, state);
  const NodeRay<format> node_ray(ray.origin, ray.direction, to_node_unit(format, arguments.reach),
                                 latest_entry(nearest.distance / cn::abs(nearest.determinant)));
  TreeWalker<format, width>(arguments.tree, arguments.record, node_ray, arguments.treelet.read(), state)
      .walk();
  state.write(arguments.record);
  cn::keep(!state.is_over(), *arguments.alive);
}

template <NodeFormat format, int width>
constexpr cn::Kernel<TraverseArguments> traverse_kernel() {
  if constexpr (NodeLayout{format, width}.has_kernel()) {
    return cn::kernel<TraverseArguments, traverse<format, width>>("traverse");
  } else {
    return {};
  }
}

template <int width>
const TraverseKernels& CN_LEVEL::traverse_kernel_table() {
  static constexpr TraverseKernels table{traverse_kernel<NodeFormat::fp64, width>(),
                                         traverse_kernel<NodeFormat::fp32, width>(),
                                         traverse_kernel<NodeFormat::quantised8, width>()};
  return table;
}

}  // namespace path_tracer
