#include "model/control/thread_processes.hpp"

namespace model {

void ThreadProcesses::add(int slot, Body body) {
  // An aggregate with an event cannot move, so there is no make_unique of it.
  // NOLINTBEGIN(modernize-make-unique)
  if (!processes_[0]) processes_[0].reset(new Process{{}, true, {}});
  processes_[std::size_t(slot)].reset(new Process{std::move(body), false, {}});
  // NOLINTEND(modernize-make-unique)
}

void ThreadProcesses::wake(int slot) {
  Process& process = *processes_[std::size_t(slot)];
  if (process.spawned) return process.woken.notify();
  process.spawned = true;
  sc_core::sc_spawn_options options;
  options.set_stack_size(kFirmwareStackBytes);
  sc_core::sc_spawn([this, &process] { run_(process.body); }, sc_core::sc_gen_unique_name("firmware_thread"),
                    &options);
}

void ThreadProcesses::switch_to(int slot, int self) {
  wake(slot);
  sc_core::wait(processes_[std::size_t(self)]->woken);
}

void ThreadProcesses::wake_all() {
  for (const auto& process : processes_)
    if (process && process->spawned) process->woken.notify();
}

}  // namespace model
