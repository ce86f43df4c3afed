#include "firmware/path_tracer/stages/ray_store.hpp"

namespace path_tracer {

int RayStore::room_bytes(const ProgramConfig& config) {
  return config.uses_tree() ? int{sizeof(QueuedRay)} + int{sizeof(MonoAddress)} : int{sizeof(RayRecord)};
}

RayRoom RayBin::take_room(BufferCutter& cutter) const {
  RayRoom room;
  room.ray = cutter.take<RayRecord>();
  return room;
}

void RayBin::save(TransferRing& saves, std::uint64_t step, const RaySlots& slots, const RayRoom& from,
                  PolyField<MonoAddress> /*light_place*/, const LaneMask& with_ray) {
  const std::uint64_t first_slot = std::uint64_t(slots.block) * std::uint64_t(machine_.num_pes());
  const cn::MonoPlaces places = slots.is_block()
                                    ? cn::MonoPlaces::array((first_ + first_slot).address, sizeof(RayRecord))
                                    : machine_.places_in(slots.bin_place);
  saves.copy_p2m(step, slots.block, places, from.ray.span(), with_ray);
}

}  // namespace path_tracer
