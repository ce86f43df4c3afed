// Built once for each x86-64 level, whose name is the namespace of the function.

#include "firmware/path_tracer/kernels/intersection.hpp"
#include "firmware/path_tracer/prefilter/tree_walk.hpp"

namespace path_tracer {
namespace {

void intersect_through_tree(const IntersectArguments& arguments) {
  const RayOperands ray = rays_to_intersect(arguments);
  Nearest nearest;
  search_tree(ray, arguments.ray.get(&RayRecord::light_face), arguments.reach,
              triangles_to_intersect(arguments), *arguments.tree, nearest);
  write_found(arguments, ray, nearest);
}

}  // namespace

inline namespace CN_LEVEL {

cn::Kernel<IntersectArguments> tree_search_kernel() {
  return cn::kernel<IntersectArguments, intersect_through_tree>("intersect");
}

}  // namespace CN_LEVEL
}  // namespace path_tracer
