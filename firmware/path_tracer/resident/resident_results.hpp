#pragma once

#include "firmware/path_tracer/kernels/resident_kernels.hpp"
#include "firmware/path_tracer/pipeline/results_handover.hpp"
#include "firmware/path_tracer/stages/transfer_ring.hpp"

namespace path_tracer {

/// Results of paths on their way from the PEs to the host. Each PE collects its own; when one has no room
/// left, all copies go to mono memory with one call, and PEs collect in the other of two buffers meanwhile.
/// Places that are still empty go along, marked as such: one call costs more than the bytes.
class ResidentResults {
 public:
  ResidentResults(cn::Machine& machine, const ResidentKernels& kernels, const Layout& layout);

  PolyPointer<RadianceRecord> buffer() const { return PolyPointer<RadianceRecord>(ring_.buffer(step_)); }
  PolyField<std::int32_t> count() const { return count_; }

  /// Empties the first buffer.
  void begin();
  /// Saves what was collected.
  void flush();
  /// Announces what was saved and not yet announced.
  void announce();

 private:
  void clear();

  cn::Machine& machine_;
  const ResidentKernels& kernels_;
  TransferRing ring_;
  ResultsHandover handover_;
  PolyField<std::int32_t> count_;
  std::uint64_t step_ = 0;
  bool is_saving_ = false;
};

}  // namespace path_tracer
