#include "model/mono_pieces.hpp"

#include <algorithm>
#include <numeric>

namespace model {
namespace {

/// Calls `visit` with each enabled PE below `num_pes` in ascending order.
template <class Visitor>
void for_each_enabled(const cn::LaneMask& enabled, int num_pes, Visitor&& visit) {
  for (int first_pe = 0; first_pe < num_pes; first_pe += cn::kStripLanes)
    for (unsigned bits = enabled.strip_bits(first_pe / cn::kStripLanes); bits != 0; bits &= bits - 1)
      visit(first_pe + __builtin_ctz(bits));
}

/// The bytes of as many packets as a piece needs wherever it lies.
std::uint64_t whole_packets(std::uint64_t bytes, const Divisor& packet) {
  return packet.quotient(bytes + packet.value() - 1) * packet.value();
}

bool is_misaligned(cn::MonoAddress address, std::uint64_t bytes, std::uint64_t packets_bytes,
                   const Divisor& packet) {
  return address % 8 != 0 || packet.remainder(address) + bytes > packets_bytes;
}

/// Of `pieces` that lie one behind the other.
int count_misaligned(cn::MonoAddress address, std::uint64_t bytes, int pieces, const Divisor& packet) {
  const std::uint64_t packets_bytes = whole_packets(bytes, packet);
  // Offsets within packets and words repeat.
  const auto period = static_cast<int>(std::lcm(packet.value(), std::uint64_t{8}) /
                                       std::gcd(std::lcm(packet.value(), std::uint64_t{8}), bytes));
  int in_period = 0;
  int in_rest = 0;
  for (int i = 0; i < std::min(period, pieces); ++i) {
    const bool misaligned = is_misaligned(address + std::uint64_t(i) * bytes, bytes, packets_bytes, packet);
    in_period += misaligned;
    if (i < pieces % period) in_rest += misaligned;
  }
  return pieces / period * in_period + in_rest;
}

}  // namespace

void MonoPieces::SeenAddresses::clear() {
  slots_.resize(kSlots);
  ++generation_;
}

bool MonoPieces::SeenAddresses::insert(cn::MonoAddress address) {
  std::size_t index = (address * 0x9e3779b97f4a7c15u) >> 32;  // Fibonacci hashing (Knuth, vol. 3, 6.4)
  for (;; ++index) {
    Slot& slot = slots_[index % kSlots];
    if (slot.generation != generation_) {
      slot = {address, generation_};
      return true;
    }
    if (slot.address == address) return false;
  }
}

void MonoPieces::describe(const cn::Transfer& transfer, int num_pes, const Rules& rules) {
  direction_ = transfer.direction;
  first_ = transfer.mono.first;
  stride_bytes_ = transfer.mono.stride_bytes;
  by_pe_.clear();
  if (transfer.mono.by_pe != nullptr) by_pe_.assign(transfer.mono.by_pe, transfer.mono.by_pe + num_pes);
  enabled_ = transfer.enabled;
  bytes_per_pe_ = transfer.poly.size_bytes;
  pes_ = pieces_ = misaligned_ = 0;
  runs_.clear();
  if (!describe_gapless_array(num_pes, rules)) describe_each(num_pes, rules);
  packets_ = 0;
  for (const Run& run : runs_)
    packets_ += rules.packet_bytes.quotient(run.bytes + rules.packet_bytes.value() - 1);
}

bool MonoPieces::describe_gapless_array(int num_pes, const Rules& rules) {
  if (!by_pe_.empty() || bytes_per_pe_ == 0 || stride_bytes_ != std::uint64_t(bytes_per_pe_)) return false;
  int lowest = num_pes;
  int highest = -1;
  int enabled_pes = 0;
  for (int first_pe = 0; first_pe < num_pes; first_pe += cn::kStripLanes) {
    const unsigned bits = enabled_.strip_bits(first_pe / cn::kStripLanes);
    if (bits == 0) continue;
    if (highest < 0) lowest = first_pe + __builtin_ctz(bits);
    highest = first_pe + 31 - __builtin_clz(bits);
    enabled_pes += __builtin_popcount(bits);
  }
  if (enabled_pes == 0 || highest - lowest + 1 != enabled_pes) return false;
  const cn::MonoAddress address = first_ + std::uint64_t(lowest) * stride_bytes_;
  pes_ = pieces_ = enabled_pes;
  runs_.emplace_back(address, std::uint64_t(enabled_pes) * stride_bytes_);
  misaligned_ = count_misaligned(address, stride_bytes_, enabled_pes, rules.packet_bytes);
  return true;
}

void MonoPieces::describe_each(int num_pes, const Rules& rules) {
  const bool consolidate = rules.consolidate_equal_addresses && !write();
  if (consolidate) seen_.clear();
  // Decided here instead of for each piece: where addresses come from, and whether some may be equal.
  const auto describe_with = [&](const auto& address_of) {
    if (consolidate) {
      describe_pieces(num_pes, rules, address_of,
                      [this](cn::MonoAddress address) { return seen_.insert(address); });
    } else {
      describe_pieces(num_pes, rules, address_of, [](cn::MonoAddress) { return true; });
    }
  };
  if (by_pe_.empty()) {
    describe_with(
        [first = first_, stride = stride_bytes_](int pe) { return first + std::uint64_t(pe) * stride; });
  } else {
    describe_with([first = first_, by_pe = by_pe_.data()](int pe) { return first + by_pe[pe]; });
  }
}

template <class AddressOf, class IsNew>
void MonoPieces::describe_pieces(int num_pes, const Rules& rules, const AddressOf& address_of,
                                 const IsNew& is_new) {
  const auto bytes = std::uint64_t(bytes_per_pe_);
  const Divisor packet = rules.packet_bytes;
  const std::uint64_t packets_bytes = whole_packets(bytes, packet);
  int pes = 0;
  int pieces = 0;
  int misaligned = 0;
  cn::MonoAddress run_address = 0;
  std::uint64_t run_bytes = 0;
  for_each_enabled(enabled_, num_pes, [&](int pe) {
    ++pes;
    const cn::MonoAddress address = address_of(pe);
    if (!is_new(address)) return;
    ++pieces;
    misaligned += is_misaligned(address, bytes, packets_bytes, packet);
    if (run_bytes != 0 && run_address + run_bytes == address) {
      run_bytes += bytes;
      return;
    }
    if (run_bytes != 0) runs_.emplace_back(run_address, run_bytes);
    run_address = address;
    run_bytes = bytes;
  });
  if (run_bytes != 0) runs_.emplace_back(run_address, run_bytes);
  pes_ = pes;
  pieces_ = pieces;
  misaligned_ = misaligned;
}

}  // namespace model
