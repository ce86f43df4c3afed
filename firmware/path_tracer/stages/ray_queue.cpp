#include "firmware/path_tracer/stages/ray_queue.hpp"

namespace path_tracer {

RayQueue::RayQueue(cn::Machine& machine, const Kernels& kernels, const Layout& layout)
    : machine_(machine),
      kernels_(kernels),
      first_(layout.ray_queue.address),
      lights_(layout.lights.address),
      number_{machine.poly_memory().allocate("numbers of rays", sizeof(std::int32_t)).offset_bytes} {}

void RayQueue::enqueue(TransferRing& saves, std::uint64_t step, PolyPointer<QueuedRay> ray,
                       PolyField<MonoAddress> light_place, std::uint64_t first_slot,
                       const LaneMask& with_ray) {
  const int count = machine_.number_ascending(with_ray, number_);
  if (count == 0) return;
  EnqueueArguments arguments;
  arguments.number = number_;
  arguments.ray = ray;
  arguments.light_place = light_place;
  arguments.lights = lights_;
  arguments.first_slot = static_cast<int>(first_slot);
  arguments.first_place = place(rays_);
  arguments.place = {ray.span().offset_bytes + PolyPointer<QueuedRay>::size_bytes()};
  machine_.run(kernels_.traversal().enqueue, arguments, with_ray);
  saves.copy_p2m(step, TransferRing::kNoBlock, machine_.places_in(arguments.place), ray.span(), with_ray);
  rays_ += count;
  last_writer_ = step;
}

}  // namespace path_tracer
