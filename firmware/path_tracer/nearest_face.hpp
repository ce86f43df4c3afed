#pragma once

#include "firmware/cn/poly_pointer.hpp"
#include "firmware/path_tracer/traversal_record.hpp"
#include "firmware/path_tracer/triangle.hpp"

namespace path_tracer {

/// A search that keeps the face of what it finds, too.
struct NearestFace : Nearest {
  poly<std::int32_t> face = kNoFace;

  template <class Triangle>
  void take(const Crossing& crossing, const Triangle& triangle) {
    Nearest::take(crossing, triangle);
    face = triangle.face;
  }
};

inline RayOperands ray_of(const cn::PolyPointer<TraversalRecord>& record) {
  return {record.get(&TraversalRecord::origin), record.get(&TraversalRecord::direction),
          record.get(&TraversalRecord::left_face)};
}

}  // namespace path_tracer
