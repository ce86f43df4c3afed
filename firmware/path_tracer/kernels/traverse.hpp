#pragma once

#include "firmware/path_tracer/geometry/nearest_face.hpp"
#include "firmware/path_tracer/kernels/traversal.hpp"
#include "firmware/path_tracer/kernels/traverse_kernels.hpp"

/// What traverse_2.cpp, traverse_4.cpp and traverse_8.cpp build, each once for each x86-64 level: apart from
/// each other because each takes a minute or two.
namespace path_tracer {

/// A leaf that each PE has its own of.
struct PolyTriangles {
  PolyPointer<TriangleRecord> first;
  int count;
  const poly<std::int32_t>& there;

  PolyTriangle operator()(int i) const {
    const PolyPointer<TriangleRecord> at = first[i];
    return {at.get(&TriangleRecord::vertex), at.get(&TriangleRecord::edge1), at.get(&TriangleRecord::edge2),
            at.get(&TriangleRecord::back),   at.get(&TriangleRecord::face),  at.get(&TriangleRecord::number)};
  }
  mask where_there(int i, const mask& lanes) const { return lanes & (there > i); }
};

/// Tests the leaf. A shadow ray is over when something is nearer than its light; one that missed its light
/// finds out what else it hits, as the light's face may have other triangles.
inline void test_leaf(const TraverseArguments& arguments, const RayOperands& ray, NearestFace& nearest,
                      Way& way) {
  const poly<std::int32_t> light_face = arguments.record.get(&TraversalRecord::light_face);
  nearest.face.become(light_face);
  const poly<std::int32_t> there =
      cn::select(cn::recall(*arguments.loaded_leaf), way.leaf_count, poly<std::int32_t>(0));
  search(ray, arguments.reach, PolyTriangles{arguments.leaf, arguments.tree.shape.leaf_records(), there},
         nearest);
  cn::poly_if(there > 0, [&] {
    const mask nothing = nearest.number < 0;
    arguments.record.set(&TraversalRecord::light_face,
                         cn::select(nothing, poly<std::int32_t>(kNoFace), light_face));
    const mask occluded = (light_face != poly<std::int32_t>(kNoFace)) & (nearest.face != light_face);
    way.node = cn::select(occluded & !nothing, poly<std::int32_t>(kTraversalOver), way.node);
    way.leaf_count = 0;
  });
  arguments.record.set(&TraversalRecord::distance, nearest.distance);
  arguments.record.set(&TraversalRecord::determinant, nearest.determinant);
  arguments.record.set(&TraversalRecord::number, nearest.number);
}

template <NodeFormat format, int width>
void traverse(const TraverseArguments& arguments) {
  const RayOperands ray = ray_of(arguments.record);
  NearestFace nearest;
  nearest.distance.become(arguments.record.get(&TraversalRecord::distance));
  nearest.determinant.become(arguments.record.get(&TraversalRecord::determinant));
  nearest.number.become(arguments.record.get(&TraversalRecord::number));
  Way way(arguments.record);
  if (arguments.loaded_leaf != nullptr) test_leaf(arguments, ray, nearest, way);
  const NodeRay<format> node_ray(ray.origin, ray.direction, to_node_unit(format, arguments.reach),
                                 latest_entry(nearest.distance / cn::abs(nearest.determinant)));
  Traveller<format, width>(arguments.tree, arguments.record, node_ray, arguments.treelet.read(), way)
      .travel();
  way.write(arguments.record);
  cn::keep(!way.is_over(), *arguments.alive);
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
const TraverseKernels& TRAVERSE_KERNELS() {
  static constexpr TraverseKernels table{traverse_kernel<NodeFormat::fp64, width>(),
                                         traverse_kernel<NodeFormat::fp32, width>(),
                                         traverse_kernel<NodeFormat::quantised8, width>()};
  return table;
}

}  // namespace path_tracer
