#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <systemc>
#include <vector>

#include "model/time/clock_domain.hpp"

namespace model {

/// What approximately timed units have to do in later cycles, in one order for the whole chip: by cycle, then
/// as it was asked for. One process serves all units: between processes of their own, the kernel would choose
/// who comes first in a cycle, and a tracing process beside them could change its choice.
class EventQueue : public sc_core::sc_module {
 public:
  using Task = std::function<void()>;  ///< up to two pointers are held without allocating

  EventQueue(const sc_core::sc_module_name& name, const ClockDomain& clock);

  /// In a cycle that is over: as soon as possible.
  void schedule(Cycles cycle, Task task);
  Cycles now() const { return clock_.cycle_at(sc_core::sc_time_stamp()); }
  /// The first cycle that is not before a TLM-2.0 delay from now, and the delay that points at a cycle.
  Cycles cycle_after(const sc_core::sc_time& delay) const;
  sc_core::sc_time delay_until(Cycles cycle) const;

  /// For the one process that runs firmware: waits until `cycle`, or for `event`, and then until everything
  /// else that happens at that time has happened, so that the firmware always comes last in a cycle.
  void pass_time_until(Cycles cycle);
  void pass_time_until(const sc_core::sc_event& event);

 private:
  /// Of what lies within so many cycles each cycle has a list of its own; a power of two.
  static constexpr Cycles kNear = 256;
  static constexpr std::size_t kUsualTasks = 16;  ///< of a cycle at most; more are allocated
  struct FarEntry {
    Cycles cycle;
    std::uint64_t number;
    Task task;
  };
  /// Of two entries, which comes later: std's heaps put the largest first.
  static bool later(const FarEntry& a, const FarEntry& b) {
    return a.cycle != b.cycle ? a.cycle > b.cycle : a.number > b.number;
  }

  void run();
  /// The next cycle that has entries; there must be one.
  Cycles next_cycle() const;
  Cycles next_near_cycle() const;
  void do_tasks_of(Cycles cycle);
  void wake_for_next();
  static void come_last();

  ClockDomain clock_;
  Cycles first_ = 0;  ///< entries of cycles before are over
  std::array<std::vector<Task>, kNear> near_;
  std::array<std::uint64_t, kNear / 64> near_filled_{};  ///< a bit a list
  std::vector<FarEntry> far_;                            ///< a heap; was asked for before what is near
  std::size_t entries_ = 0;
  std::uint64_t asked_ = 0;
  bool running_ = false;
  sc_core::sc_event wake_;
};

}  // namespace model
