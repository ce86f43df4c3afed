#include "firmware/path_tracer/stages/transfer_ring.hpp"

namespace path_tracer {
namespace {

// Instructions of the control unit for the bookkeeping, as a compiler would make it (assumed): a request is
// four arguments, an address and the call; checking one ring entry is a load, a compare and a branch.
constexpr std::uint64_t kRequestInstructions = 12;
constexpr std::uint64_t kEntryInstructions = 3;

}  // namespace

TransferRing::TransferRing(cn::Machine& machine, const std::string& name, const Buffers& buffers)
    : machine_(machine), synchronous_(buffers.synchronous) {
  for (int i = 0; i < buffers.count; ++i) {
    const std::string label = name + " " + std::to_string(i);
    entries_.push_back(
        {machine.poly_memory().allocate(label, buffers.bytes), machine.allocate_semaphore(label)});
  }
}

TransferRing::Entry& TransferRing::claim(std::uint64_t step, int block) {
  machine_.issue_mono(kRequestInstructions);
  Entry& claimed = entry(step);
  claimed.step = step;
  claimed.block = block;
  ++claimed.pending;
  return claimed;
}

void TransferRing::copy_m2p(std::uint64_t step, int block, cn::PolySpan destination,
                            const cn::MonoPlaces& source, const cn::LaneMask& enabled) {
  Entry& claimed = claim(step, block);
  machine_.async_copy_m2p(claimed.done, destination, source, enabled);
  if (synchronous_) wait(claimed);
}

void TransferRing::copy_p2m(std::uint64_t step, int block, const cn::MonoPlaces& destination,
                            cn::PolySpan source, const cn::LaneMask& enabled) {
  Entry& claimed = claim(step, block);
  machine_.async_copy_p2m(claimed.done, destination, source, enabled);
  if (synchronous_) wait(claimed);
}

void TransferRing::wait(Entry& entry) {
  machine_.issue_mono(kEntryInstructions);
  for (; entry.pending > 0; --entry.pending) machine_.sem_wait(entry.done);
}

void TransferRing::wait(std::uint64_t step) {
  wait(entry(step));
}

void TransferRing::wait_block(int block) {
  machine_.issue_mono(kEntryInstructions * entries_.size());
  for (Entry& entry : entries_)
    if (entry.pending > 0 && entry.block == block) wait(entry);
}

void TransferRing::wait_until(std::uint64_t step) {
  machine_.issue_mono(kEntryInstructions * entries_.size());
  for (Entry& entry : entries_)
    if (entry.pending > 0 && entry.step <= step) wait(entry);
}

}  // namespace path_tracer
