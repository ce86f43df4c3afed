#include "firmware/path_tracer/stages/ray_queue.hpp"

namespace path_tracer {

RayQueue::RayQueue(cn::Machine& machine, const Kernels& kernels, const Layout& layout)
    : machine_(machine),
      kernels_(kernels),
      first_(layout.ray_queue.address),
      lights_(layout.lights.address),
      number_{machine.poly_memory().allocate("numbers of rays", sizeof(std::int32_t)).offset_bytes} {}

RayRoom RayQueue::take_room(BufferCutter& cutter) const {
  const PolyPointer<QueuedRay> queued = cutter.take<QueuedRay>();
  return {queued.part(&QueuedRay::ray), queued, cutter.take_place()};
}

void RayQueue::save(TransferRing& saves, std::uint64_t step, const RaySlots& slots, const RayRoom& from,
                    PolyField<MonoAddress> light_place, const LaneMask& with_ray) {
  const int count = machine_.number_ascending(with_ray, number_);
  if (count == 0) return;
  EnqueueArguments arguments;
  arguments.number = number_;
  arguments.ray = from.queued;
  arguments.light_place = light_place;
  arguments.lights = lights_;
  arguments.first_slot = slots.block * machine_.num_pes();
  if (!slots.is_block()) arguments.slots = &slots.slot;
  arguments.first_place = place(rays_);
  arguments.place = from.place;
  machine_.run(kernels_.traversal().enqueue, arguments, with_ray);
  saves.copy_p2m(step, TransferRing::kNoBlock, machine_.places_in(from.place), from.queued.span(), with_ray);
  rays_ += count;
  last_writer_ = step;
}

}  // namespace path_tracer
