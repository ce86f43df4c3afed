#pragma once

#include <functional>
#include <memory>
#include <systemc>
#include <vector>

namespace model {

/// Firmware runs whole programs on its stack; SystemC's default of 256 KiB is for small processes.
inline constexpr int kFirmwareStackBytes = 8 << 20;

/// The stacks of hardware threads. They are SystemC processes, since time passes (wait()) deep within
/// firmware's calls and SystemC knows no other stacks. A process is spawned when a thread that was started is
/// first woken: firmware of one thread has only the control unit's own process. One of them is awake at a
/// time.
class ThreadProcesses {
 public:
  using Body = std::function<void()>;

  /// @param limit threads, the first one, which has the control unit's own process, included
  /// @param run what each process does with its thread's body
  ThreadProcesses(int limit, std::function<void(const Body&)> run)
      : run_(std::move(run)), processes_(std::size_t(limit)) {}

  /// A thread in `slot`, instead of one that is over.
  void add(int slot, Body body);
  void wake(int slot);
  /// Wakes `slot`; returns when the caller, which has slot `self`, is woken.
  void switch_to(int slot, int self);
  void wake_all();

 private:
  struct Process {
    Body body;
    bool spawned;
    sc_core::sc_event woken;
  };

  std::function<void(const Body&)> run_;
  std::vector<std::unique_ptr<Process>> processes_;  ///< by slot; all null until a second thread is started
};

}  // namespace model
