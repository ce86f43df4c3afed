#pragma once

#include "firmware/path_tracer/kernels/kernels.hpp"
#include "firmware/path_tracer/stages/transfer_ring.hpp"

namespace path_tracer {

/// The ray bin of programs that use a tree. A ray's way through the tree ends in another PE than it began in,
/// so rays need not stand in their slots: they stand packed, and PEs that are idle take the next ones.
class RayQueue {
 public:
  RayQueue(cn::Machine& machine, const Kernels& kernels, const Layout& layout);

  /// Bytes that enqueue() wants behind a QueuedRay in SRAM, until the save is over.
  static constexpr int kPlaceBytes = sizeof(cn::MonoAddress);

  /// Appends the rays of the lanes `with_ray`.
  /// @param ray a QueuedRay, of which the RayRecord is filled, and a place behind it
  /// @param light_place of the block of slots
  void enqueue(TransferRing& saves, std::uint64_t step, PolyPointer<QueuedRay> ray,
               PolyField<MonoAddress> light_place, std::uint64_t first_slot, const LaneMask& with_ray);

  int rays() const { return rays_; }  ///< appended since clear()
  int left() const { return rays_ - taken_; }
  /// The step whose save was the last to bring rays.
  std::uint64_t last_writer() const { return last_writer_; }
  /// Place of the next ray that nobody took.
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
