#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <systemc>
#include <vector>

#include "model/time/clock_domain.hpp"
#include "model/time/last_in_time.hpp"

namespace model {

/// Event queue of the approximately timed model: the tasks of all units by cycle, then in order of request.
/// One SystemC process runs them all. If each unit had its own process, the kernel would choose which comes
/// first in a cycle, and a tracing process beside them could change its choice.
class EventQueue : public sc_core::sc_module {
 public:
  using Task = std::function<void()>;  ///< up to two pointers are held without allocating

  EventQueue(const sc_core::sc_module_name& name, const ClockDomain& clock);
  /// For the firmware of another array of the chip: its units' tasks are run by `chip`, in one order with all
  /// others; the firmware has a turn of its own.
  EventQueue(const sc_core::sc_module_name& name, EventQueue& chip);

  /// Runs `task` in `cycle`, or as soon as possible if that is over.
  void schedule(Cycles cycle, Task task);
  Cycles now() const { return clock_.cycle_at(sc_core::sc_time_stamp()); }
  /// The first cycle that is not before now + `delay`.
  Cycles cycle_after(const sc_core::sc_time& delay) const;
  /// The TLM-2.0 delay from now to `cycle`; zero if that is over.
  sc_core::sc_time delay_until(Cycles cycle) const;

  /// For the one process that runs firmware: waits until `cycle`, or for `event`, and then until everything
  /// else that happens at that time has happened, so that the firmware always comes last in a cycle. The
  /// firmware of several chips in a simulation comes last chip by chip (LastInTime).
  void pass_time_until(Cycles cycle);
  void pass_time_until(const sc_core::sc_event& event);

 private:
  /// Each of the next so many cycles has a list of its own; a power of two.
  static constexpr Cycles kNear = 256;
  static constexpr std::size_t kUsualTasks = 16;  ///< room of a list; more are allocated
  struct FarEntry {
    Cycles cycle;
    std::uint64_t number;
    Task task;
  };
  /// Whether `a` comes after `b`: std's heaps put the largest first.
  static bool later(const FarEntry& a, const FarEntry& b) {
    return a.cycle != b.cycle ? a.cycle > b.cycle : a.number > b.number;
  }

  /// Shares `last_in_time_` with the other event queues, which it finds among SystemC's objects.
  void join_other_chips(const std::vector<sc_core::sc_object*>& objects);
  void run();
  /// The next cycle that has tasks; there must be one.
  Cycles next_cycle() const;
  Cycles next_near_cycle() const;
  void do_tasks_of(Cycles cycle);

  ClockDomain clock_;
  EventQueue* runs_tasks_ = nullptr;  ///< the chip's, where it is not this one
  Cycles first_ = 0;                  ///< earlier cycles have no tasks left
  std::array<std::vector<Task>, kNear> near_;
  std::array<std::uint64_t, kNear / 64> near_filled_{};  ///< one bit per list
  std::vector<FarEntry> far_;  ///< a heap; scheduled before the near tasks of the same cycle
  std::size_t entries_ = 0;
  std::uint64_t asked_ = 0;
  bool running_ = false;
  sc_core::sc_event wake_;
  std::shared_ptr<LastInTime> last_in_time_;  ///< of all event queues in the simulation
  std::size_t place_ = 0;                     ///< of this chip's firmware there
};

}  // namespace model
