#pragma once

#include <algorithm>
#include <cstring>
#include <deque>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "firmware/cn/machine.hpp"

namespace test_support {

/// cn::Machine whose transfers are as late as allowed: data and addresses move only when the firmware waits
/// for them, and until then the destination holds garbage. With `eagerness`, some transfers finish before
/// they are waited for, in any order.
class LateMachine : public cn::Machine {
 public:
  LateMachine(int num_pes, int poly_bytes_per_pe, std::uint64_t mono_bytes, double eagerness = 0)
      : Machine(num_pes, poly_bytes_per_pe), mono_(mono_bytes), eagerness_(eagerness) {}

  std::uint8_t* mono() { return mono_.data(); }

  /// Called when the firmware waits for a semaphore that no transfer will signal. The host must react now at
  /// the latest.
  std::function<void(cn::Semaphore)> host;
  /// Called when the firmware signals, for a host that reacts promptly.
  std::function<void(cn::Semaphore)> on_signal;

  /// The calls of the firmware, for example "m2p load 0", "wait load 0", "signal results ready".
  std::vector<std::string> calls;
  std::uint64_t mono_instructions = 0;

  /// Throws a fault if, in a PE that takes part in both, a transfer writes poly memory that an outstanding
  /// transfer uses, or reads what one writes.
  bool guards_buffers = false;

  std::size_t under_way() const { return pending_.size(); }
  int signals(cn::Semaphore semaphore) const { return semaphores_[std::size_t(semaphore.index)]; }
  bool take_signal(cn::Semaphore semaphore) {
    int& count = semaphores_[std::size_t(semaphore.index)];
    return count > 0 && count-- > 0;
  }

  void sem_signal(cn::Semaphore semaphore) override {
    calls.push_back("signal " + semaphore_name(semaphore));
    ++semaphores_[std::size_t(semaphore.index)];
    if (on_signal) on_signal(semaphore);
  }
  void sem_wait(cn::Semaphore semaphore) override {
    calls.push_back("wait " + semaphore_name(semaphore));
    if (signals(semaphore) == 0)
      finish_one([&](const cn::Transfer& t) { return t.done.index == semaphore.index; });
    if (signals(semaphore) == 0 && host) host(semaphore);
    if (!take_signal(semaphore))
      throw cn::MachineFault("deadlock at semaphore '" + semaphore_name(semaphore) + "'");
    finish_some();
  }
  void issue_mono(std::uint64_t instructions) override { mono_instructions += instructions; }
  /// Finishes all outstanding transfers, since untimed work may use their data.
  void timed(bool on) override {
    while (!on && finish_one([](const cn::Transfer&) { return true; })) {
    }
  }

 protected:
  void retire(const char*, const cn::IssueTree&) override { finish_some(); }
  void start_transfer(const cn::Transfer& transfer) override {
    const bool to_poly = transfer.direction == cn::Direction::mono_to_poly;
    calls.push_back((to_poly ? "m2p " : "p2m ") + semaphore_name(transfer.done));
    if (guards_buffers && buffer_is_in_use(transfer))
      throw cn::MachineFault("the poly buffer of " + calls.back() + " is in use by a transfer under way");
    pending_.push_back(transfer);
    spoil(transfer);
  }
  const void* read_mono_bytes(cn::MonoAddress from, std::size_t) override { return mono_.data() + from; }
  void write_mono_bytes(cn::MonoAddress to, const void* bytes, std::size_t size) override {
    std::memcpy(mono_.data() + to, bytes, size);
  }

 private:
  static constexpr int kGarbage = 0xa5;

  void check_range(const cn::Transfer& transfer) const {
    for (int pe = 0; pe < num_pes(); ++pe)
      if (transfer.enabled[pe] && transfer.mono[pe] > mono_.size() - std::size_t(transfer.poly.size_bytes))
        throw cn::MachineFault(semaphore_name(transfer.done) + ": PE " + std::to_string(pe) +
                               " has the address " + std::to_string(transfer.mono[pe]));
  }

  void spoil(const cn::Transfer& transfer) {
    check_range(transfer);
    for (int pe = 0; pe < num_pes(); ++pe) {
      if (!transfer.enabled[pe]) continue;
      if (transfer.direction == cn::Direction::poly_to_mono) {
        std::memset(mono_.data() + transfer.mono[pe], kGarbage, std::size_t(transfer.poly.size_bytes));
      } else {
        for (int byte = 0; byte < transfer.poly.size_bytes; byte += 8)
          std::memset(&poly_memory().word(pe, transfer.poly.offset_bytes + byte), kGarbage, 8);
      }
    }
  }

  bool share_a_pe(const cn::Transfer& a, const cn::Transfer& b) const {
    return a.enabled.without(b.enabled).count() < a.enabled.count();
  }

  bool buffer_is_in_use(const cn::Transfer& transfer) const {
    const auto overlaps = [&](const cn::PolySpan& a, const cn::PolySpan& b) {
      return a.offset_bytes < b.offset_bytes + b.size_bytes && b.offset_bytes < a.offset_bytes + a.size_bytes;
    };
    return std::any_of(pending_.begin(), pending_.end(), [&](const cn::Transfer& other) {
      const bool both_read =
          transfer.direction == cn::Direction::poly_to_mono && other.direction == transfer.direction;
      return !both_read && overlaps(transfer.poly, other.poly) && share_a_pe(transfer, other);
    });
  }

  template <class Which>
  bool finish_one(Which which) {
    const auto found = std::find_if(pending_.begin(), pending_.end(), which);
    if (found == pending_.end()) return false;
    finish(found);
    return true;
  }
  void finish(std::deque<cn::Transfer>::iterator transfer) {
    check_range(*transfer);
    cn::move_data(*transfer, poly_memory(), mono_.data());
    ++semaphores_[std::size_t(transfer->done.index)];
    pending_.erase(transfer);
  }
  void finish_some() {
    for (std::size_t i = pending_.size(); i > 0; --i)
      if (std::uniform_real_distribution<double>()(random_) < eagerness_)
        finish(pending_.begin() + static_cast<std::ptrdiff_t>(random_() % pending_.size()));
  }

  std::vector<std::uint8_t> mono_;
  double eagerness_;
  std::deque<cn::Transfer> pending_;
  int semaphores_[kSemaphores] = {};
  std::mt19937 random_{17};
};

}  // namespace test_support
