#include "model/observe/control_observer.hpp"

#include <array>
#include <cstddef>

namespace model {

const char* cycle_cause_name(CycleCause cause) {
  static constexpr std::array<const char*, kCycleCauses> kNames = {
      "poly",      "stolen",    "mono",           "data_cache", "semaphore",    "transfer_call",
      "wait_load", "wait_save", "wait_pio_queue", "wait_host",  "thread_switch"};
  return kNames.at(std::size_t(cause));
}

const char* thread_state_name(ThreadState state) {
  static constexpr std::array<const char*, kThreadStates> kNames = {"none", "ready", "running", "waiting"};
  return kNames.at(std::size_t(state));
}

}  // namespace model
