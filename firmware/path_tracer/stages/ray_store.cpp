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

void RayBin::save(TransferRing& saves, std::uint64_t step, int block, const RayRoom& from,
                  PolyField<MonoAddress> /*light_place*/, const LaneMask& with_ray) {
  const std::uint64_t first_slot = std::uint64_t(block) * std::uint64_t(num_pes_);
  saves.copy_p2m(step, block, cn::MonoPlaces::array((first_ + first_slot).address, sizeof(RayRecord)),
                 from.ray.span(), with_ray);
}

}  // namespace path_tracer
