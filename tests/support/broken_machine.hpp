#pragma once

#include <array>
#include <deque>
#include <vector>

#include "testbench/machine/native_machine.hpp"

namespace test_support {

/// A machine that leaves out one wait for a transfer.
class BrokenMachine : public testbench::NativeMachine {
 public:
  /// @param dropped_wait number of the wait for a transfer, from 0, that returns at once and takes no signal;
  /// -1 for none
  BrokenMachine(int num_pes, int poly_bytes, std::uint64_t mono_bytes, int dropped_wait)
      : NativeMachine(num_pes, poly_bytes, mono_bytes), dropped_wait_(dropped_wait) {}

  /// Semaphores up to this one are not signalled by transfers.
  void set_last_host_semaphore(cn::Semaphore last) { last_host_semaphore_ = last.index; }

  void sem_wait(cn::Semaphore semaphore) override {
    const bool for_transfer = semaphore.index > last_host_semaphore_;
    if (for_transfer && note_wait(waits_[std::size_t(semaphore.index)]) && next_wait_++ == dropped_wait_)
      return;
    NativeMachine::sem_wait(semaphore);
  }
  void timed(bool on) override {
    timed_ = on;
    NativeMachine::timed(on);
  }
  /// Numbers of the waits in timed work that the firmware needs: on each semaphore, all waits up to the last
  /// for a transfer that moves data.
  const std::vector<int>& needed_waits() const { return needed_waits_; }

 protected:
  void start_transfer(const cn::Transfer& transfer) override {
    waits_[std::size_t(transfer.done.index)].moves_data.push_back(transfer.enabled.any());
    NativeMachine::start_transfer(transfer);
  }

 private:
  struct Waits {
    std::deque<bool> moves_data;  ///< transfers that have not been waited for, in the order of their signals
    std::vector<int> perhaps_needed;
  };

  /// Whether the wait counts among the timed waits for transfers.
  bool note_wait(Waits& waits) {
    if (waits.moves_data.empty()) return false;  // the machine reports this wait as a fault
    const bool moved_data = waits.moves_data.front();
    waits.moves_data.pop_front();
    if (!timed_) return false;
    waits.perhaps_needed.push_back(next_wait_);
    if (!moved_data) return true;
    needed_waits_.insert(needed_waits_.end(), waits.perhaps_needed.begin(), waits.perhaps_needed.end());
    waits.perhaps_needed.clear();
    return true;
  }

  int dropped_wait_;
  int last_host_semaphore_ = -1;
  int next_wait_ = 0;
  std::array<Waits, kSemaphores> waits_;
  std::vector<int> needed_waits_;
  bool timed_ = true;
};

}  // namespace test_support
