#pragma once

#include <array>
#include <deque>
#include <optional>

#include "firmware/cn/machine.hpp"
#include "model/time/cycles.hpp"

namespace model {

/// The signals of the chip's semaphores that nobody has taken, each as the cycle at which it arrives. A
/// signal may be known before it arrives.
class SemaphoreFile {
 public:
  void signal(int index, Cycles at) {
    auto& pending = pending_.at(std::size_t(index));
    auto position = pending.end();
    while (position != pending.begin() && *std::prev(position) > at) --position;
    pending.insert(position, at);
  }

  /// Takes the earliest signal and returns when it arrives; std::nullopt when none is known.
  std::optional<Cycles> take(int index) {
    auto& pending = pending_.at(std::size_t(index));
    if (pending.empty()) return std::nullopt;
    const Cycles at = pending.front();
    pending.pop_front();
    return at;
  }

  bool has_signal(int index, Cycles now) const {
    const auto& pending = pending_.at(std::size_t(index));
    return !pending.empty() && pending.front() <= now;
  }

  /// Signals known and not taken, arrived or not.
  int count(int index) const { return static_cast<int>(pending_.at(std::size_t(index)).size()); }

  /// When the earliest signal that nobody has taken arrives; std::nullopt when none is known.
  std::optional<Cycles> first_signal(int index) const {
    const auto& pending = pending_.at(std::size_t(index));
    return pending.empty() ? std::nullopt : std::optional(pending.front());
  }

 private:
  std::array<std::deque<Cycles>, cn::Machine::kSemaphores> pending_;
};

}  // namespace model
