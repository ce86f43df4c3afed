#pragma once

#include "firmware/cn/machine.hpp"
#include "firmware/path_tracer/program/layout.hpp"

namespace path_tracer {

/// Semaphores that the firmware shares with the host. Both sides know them by number, as the host's driver
/// does.
struct HostSemaphores {
  static constexpr cn::Semaphore kResultsReady{
      0};  ///< the firmware signals that one half of the results is full
  static constexpr cn::Semaphore kResultsFree{1};  ///< the host signals that it has read that half

  /// Takes semaphores 0 and 1, before any other. Throws cn::MachineFault when they are taken.
  static void allocate(cn::Machine& machine);
};

/// Hands results to the host. The host reads one half of the results while the firmware fills the other.
class ResultsHandover {
 public:
  ResultsHandover(cn::Machine& machine, const Layout& layout) : machine_(machine), layout_(layout) {}

  /// The half that the firmware may fill.
  cn::MonoPointer<RadianceRecord> half() const { return layout_.results[half_]; }

  /// Tells the host that the half is full of `records` results. Then waits until the other half is free.
  void announce(int records);

 private:
  cn::Machine& machine_;
  const Layout& layout_;
  int half_ = 0;
  int announcements_ = 0;
};

}  // namespace path_tracer
