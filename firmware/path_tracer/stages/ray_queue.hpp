#pragma once

#include "firmware/path_tracer/stages/ray_store.hpp"

namespace path_tracer {

/// The ray queue of a tree traversal. A ray's traversal ends in another PE than it began in, so rays need not
/// stand in their slots: the queue holds them packed, and idle PEs take the next ones.
class RayQueue : public RayStore {
 public:
  RayQueue(cn::Machine& machine, const Kernels& kernels, const Layout& layout);

  RayRoom take_room(BufferCutter& cutter) const override;
  /// Appends the rays, packed.
  void save(TransferRing& saves, std::uint64_t step, const RaySlots& slots, const RayRoom& from,
            PolyField<MonoAddress> light_place, const LaneMask& with_ray) override;

  int rays() const { return rays_; }  ///< appended since clear()
  int left() const { return rays_ - taken_; }
  /// The latest step whose save brought rays.
  std::uint64_t last_writer() const { return last_writer_; }
  /// Place of the next ray to take.
  cn::MonoAddress next_place() const { return place(taken_); }
  void take(int rays) { taken_ += rays; }
  void clear() { rays_ = taken_ = 0; }

 private:
  cn::MonoAddress place(int ray) const { return first_ + std::uint64_t(ray) * sizeof(QueuedRay); }

  cn::Machine& machine_;
  const Kernels& kernels_;
  cn::MonoAddress first_;
  cn::MonoAddress lights_;
  PolyField<std::int32_t> number_;
  int rays_ = 0;
  int taken_ = 0;
  std::uint64_t last_writer_ = 0;
};

}  // namespace path_tracer
