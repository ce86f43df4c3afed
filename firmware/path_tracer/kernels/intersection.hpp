#pragma once

#include "firmware/path_tracer/kernels/kernels.hpp"
#include "firmware/path_tracer/kernels/places.hpp"

/// What the ways to intersect a block's rays share (IntersectArguments).
namespace path_tracer {

inline RayOperands rays_to_intersect(const IntersectArguments& arguments) {
  RayOperands ray{arguments.ray.get(&RayRecord::origin), arguments.ray.get(&RayRecord::direction),
                  arguments.ray.get(&RayRecord::left_face)};
  ray.measure_from_anchor(arguments.layers);
  return ray;
}

inline MonoTriangles triangles_to_intersect(const IntersectArguments& arguments) {
  return {arguments.triangles, arguments.triangle_count, arguments.layers.record_bytes()};
}

inline void write_found(const IntersectArguments& arguments, const RayOperands& ray, const Nearest& nearest) {
  write_hit(nearest, ray.origin, ray.direction, arguments.hit, arguments.hit_has_tail);
  arguments.surface_place.write(place_of(arguments.surfaces, nearest.number));
  cn::keep(nearest.number >= 0, *arguments.hit_something);
}

}  // namespace path_tracer
