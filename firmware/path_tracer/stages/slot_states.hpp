#pragma once

#include "firmware/path_tracer/stages/stage.hpp"

namespace path_tracer {

/// Of stream execution: the state of slots (SlotState), which comes from mono memory before each kernel and
/// goes back behind it. A buffer belongs to a step from its load to the end of its save.
class SlotStates {
 public:
  /// Of the context's bins.
  explicit SlotStates(const StageContext& context);

  /// Begins to load the state of a block, after its last save; what the PEs knew of it is gone.
  void load(std::uint64_t step, int block);
  /// Waits for the state and makes it known.
  void recall(std::uint64_t step, int block);
  /// Takes a buffer for a block that has no state yet.
  void claim(std::uint64_t step, int block);
  void save(std::uint64_t step, int block);
  /// Waits until the saves of steps up to `step` are over.
  void wait_until(std::uint64_t step) { ring_.wait_until(step); }

 private:
  PolyPointer<SlotState> state(std::uint64_t step) const {
    return PolyPointer<SlotState>(ring_.buffer(step));
  }
  cn::MonoPlaces places(int block) const;
  void point_to(std::uint64_t step, int block);
  Bins::Block& slots(int block) const { return bins_.blocks[std::size_t(block)]; }

  cn::Machine& machine_;
  const Kernels& kernels_;
  Bins& bins_;
  cn::MonoPointer<SlotState> first_;
  bool buffers_loads_;
  bool buffers_saves_;
  TransferRing ring_;
};

}  // namespace path_tracer
