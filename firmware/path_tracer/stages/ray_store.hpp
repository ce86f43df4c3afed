#pragma once

#include "firmware/path_tracer/kernels/kernels.hpp"
#include "firmware/path_tracer/program/layout.hpp"
#include "firmware/path_tracer/stages/buffer_cutter.hpp"
#include "firmware/path_tracer/stages/transfer_ring.hpp"

namespace path_tracer {

/// Room for a ray in a save buffer. The ray queue has its ray within a longer record.
struct RayRoom {
  PolyPointer<RayRecord> ray;
  PolyPointer<QueuedRay> queued;  ///< contains `ray`; in the ray queue only, as `place`
  PolyField<MonoAddress> place;   ///< in SRAM, for the mono address of `queued` until its save is over
};

/// The slots whose rays a step saves: those of a block, or in each PE one of its own.
struct RaySlots {
  int block = TransferRing::kNoBlock;
  // Of PEs with slots of their own:
  PolyField<std::int32_t> slot{};
  PolyField<MonoAddress> bin_place{};  ///< of the slot in the ray bin of brute force

  bool is_block() const { return block != TransferRing::kNoBlock; }
};

/// Store of the rays that stages make for the ray search: the ray bin of brute force or the ray queue of a
/// tree traversal.
class RayStore {
 public:
  RayStore() = default;
  virtual ~RayStore() = default;
  RayStore(const RayStore&) = delete;
  RayStore& operator=(const RayStore&) = delete;

  /// Size of what take_room() takes of a save buffer.
  static int room_bytes(const ProgramConfig& config);
  virtual RayRoom take_room(BufferCutter& cutter) const = 0;

  /// Saves the rays of the lanes `with_ray`.
  /// @param from its `ray` is filled
  /// @param light_place of the light of each shadow ray
  virtual void save(TransferRing& saves, std::uint64_t step, const RaySlots& slots, const RayRoom& from,
                    PolyField<MonoAddress> light_place, const LaneMask& with_ray) = 0;
};

/// The ray bin: one RayRecord for each slot.
class RayBin : public RayStore {
 public:
  RayBin(cn::Machine& machine, const Layout& layout) : machine_(machine), first_(layout.ray_bin) {}

  RayRoom take_room(BufferCutter& cutter) const override;
  void save(TransferRing& saves, std::uint64_t step, const RaySlots& slots, const RayRoom& from,
            PolyField<MonoAddress> light_place, const LaneMask& with_ray) override;

 private:
  cn::Machine& machine_;
  cn::MonoPointer<RayRecord> first_;
};

}  // namespace path_tracer
