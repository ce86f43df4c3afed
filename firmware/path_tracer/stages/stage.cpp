#include "firmware/path_tracer/stages/stage.hpp"

#include "firmware/path_tracer/stages/ray_queue.hpp"

namespace path_tracer {

int Stage::ray_bytes(const ProgramConfig& config) {
  return config.uses_tree() ? int{sizeof(QueuedRay)} + RayQueue::kPlaceBytes : int{sizeof(RayRecord)};
}

PolyPointer<QueuedRay> Stage::take_ray(BufferCutter& cutter) const {
  if (context_.queue == nullptr) return PolyPointer<QueuedRay>(cutter.take<RayRecord>().span().offset_bytes);
  const PolyPointer<QueuedRay> ray = cutter.take<QueuedRay>();
  cutter.take_place();
  return ray;
}

void Stage::save_rays(std::uint64_t step, int block, PolyPointer<QueuedRay> from, const LaneMask& with_ray) {
  if (context_.queue == nullptr) {
    save_block(step, block, context_.layout.ray_bin, PolyPointer<RayRecord>(from.span().offset_bytes),
               with_ray);
  } else {
    context_.queue->enqueue(context_.saves, step, from, bin_block(block).light_place, first_slot(block),
                            with_ray);
  }
}

}  // namespace path_tracer
