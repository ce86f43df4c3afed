#pragma once

#include "firmware/cn/language/poly_pointer.hpp"
#include "firmware/path_tracer/geometry/triangle.hpp"
#include "firmware/path_tracer/records/traversal_record.hpp"

namespace path_tracer {

/// A search result with the face of the nearest triangle.
struct NearestFace : Nearest {
  poly<std::int32_t> face = kNoFace;

  template <class Triangle>
  void take(const Crossing& crossing, const Triangle& triangle) {
    Nearest::take(crossing, triangle);
    face = triangle.face;
  }
};

inline RayOperands ray_of(const cn::PolyPointer<TraversalRecord>& record, const Layers& layers) {
  RayOperands ray{record.get(&TraversalRecord::origin), record.get(&TraversalRecord::direction),
                  record.get(&TraversalRecord::left_face)};
  ray.measure_from_anchor(layers);
  return ray;
}

}  // namespace path_tracer
