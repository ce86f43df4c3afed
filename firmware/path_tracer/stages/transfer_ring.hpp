#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "firmware/cn/machine.hpp"

namespace path_tracer {

/// n-buffering in one direction (paper, section 3.3): as many poly buffers as steps may be under way at once,
/// used in turn by step number. Each has a semaphore that counts its finished transfers. All stages use the
/// same ring, so that the last steps of a stage overlap with the first of the next.
///
/// In a synchronous ring each copy is over before the next instruction ("0-buffering simply means that each
/// load or save operation was carried out when it occurred in the code", paper, section 4.1).
class TransferRing {
 public:
  struct Buffers {
    int count;
    int bytes;
    bool synchronous;
  };

  TransferRing(cn::Machine& machine, const std::string& name, const Buffers& buffers);

  cn::PolySpan buffer(std::uint64_t step) const { return entry(step).span; }

  /// Block of transfers that belong to no block of slots.
  static constexpr int kNoBlock = -1;
  void copy_m2p(std::uint64_t step, int block, cn::PolySpan destination, const cn::MonoPlaces& source,
                const cn::LaneMask& enabled);
  void copy_p2m(std::uint64_t step, int block, const cn::MonoPlaces& destination, cn::PolySpan source,
                const cn::LaneMask& enabled);

  /// Waits until all transfers in the buffer that `step` uses are over, whichever step started them.
  void wait(std::uint64_t step);

  /// Waits until all transfers that were started for records of `block` are over.
  void wait_block(int block);

  /// Waits until all transfers of steps up to `step` are over.
  void wait_until(std::uint64_t step);

 private:
  struct Entry {
    cn::PolySpan span;
    cn::Semaphore done;
    std::uint64_t step = 0;
    int block = kNoBlock;
    int pending = 0;  ///< transfers started and not waited for
  };

  Entry& entry(std::uint64_t step) { return entries_[step % entries_.size()]; }
  const Entry& entry(std::uint64_t step) const { return entries_[step % entries_.size()]; }
  Entry& claim(std::uint64_t step, int block);
  void wait(Entry& entry);

  cn::Machine& machine_;
  bool synchronous_;
  std::vector<Entry> entries_;
};

}  // namespace path_tracer
