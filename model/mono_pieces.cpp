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

constexpr int kWordLanes = 64;

/// The enable bits of PEs first_pe .. first_pe + 63 below `num_pes`.
std::uint64_t enabled_word(const cn::LaneMask& enabled, int first_pe, int num_pes) {
  const int strips = std::min(kWordLanes, num_pes - first_pe) / cn::kStripLanes;
  std::uint64_t word = 0;
  for (int strip = 0; strip < strips; ++strip)
    word |= std::uint64_t{enabled.strip_bits(first_pe / cn::kStripLanes + strip)}
            << (strip * cn::kStripLanes);
  return word;
}

/// One bit a piece of a packed array: whether it is misaligned. Offsets within packets and words repeat after
/// `period` pieces, so for a period that divides 64 the same word holds for every 64 pieces.
class MisalignedPattern {
 public:
  MisalignedPattern(cn::MonoAddress first, std::uint64_t bytes, const Divisor& packet) {
    const std::uint64_t whole = std::lcm(packet.value(), std::uint64_t{8});
    const std::uint64_t period = whole / std::gcd(whole, bytes);
    repeats_ = kWordLanes % period == 0;
    const std::uint64_t packets_bytes = whole_packets(bytes, packet);
    for (std::uint64_t piece = 0; repeats_ && piece < period; ++piece)
      if (is_misaligned(first + piece * bytes, bytes, packets_bytes, packet))
        for (std::uint64_t place = piece; place < kWordLanes; place += period)
          word_ |= std::uint64_t{1} << place;
  }
  bool repeats() const { return repeats_; }
  std::uint64_t word() const { return word_; }

 private:
  bool repeats_;
  std::uint64_t word_ = 0;
};

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
  if (!describe_packed_array(num_pes, rules)) describe_each(num_pes, rules);
  packets_ = 0;
  for (const Run& run : runs_)
    packets_ += rules.packet_bytes.quotient(run.bytes + rules.packet_bytes.value() - 1);
}

/// An array without gaps between its pieces, whichever PEs take part: runs are runs of enable bits.
bool MonoPieces::describe_packed_array(int num_pes, const Rules& rules) {
  if (!by_pe_.empty() || bytes_per_pe_ == 0 || stride_bytes_ != std::uint64_t(bytes_per_pe_)) return false;
  const MisalignedPattern pattern(first_, stride_bytes_, rules.packet_bytes);
  if (!pattern.repeats()) return false;
  int run_end = -1;
  for (int first_pe = 0; first_pe < num_pes; first_pe += kWordLanes) {
    std::uint64_t bits = enabled_word(enabled_, first_pe, num_pes);
    pes_ += __builtin_popcountll(bits);
    misaligned_ += __builtin_popcountll(bits & pattern.word());
    while (bits != 0) {
      const int start = __builtin_ctzll(bits);
      const std::uint64_t above = bits + (std::uint64_t{1} << start);  // 0 when the run reaches bit 63
      const int end = above == 0 ? kWordLanes : __builtin_ctzll(above);
      const std::uint64_t run_bytes = std::uint64_t(end - start) * stride_bytes_;
      if (first_pe + start == run_end) {
        runs_.back().bytes += run_bytes;
      } else {
        runs_.emplace_back(first_ + std::uint64_t(first_pe + start) * stride_bytes_, run_bytes);
      }
      run_end = first_pe + end;
      bits &= above == 0 ? 0 : ~std::uint64_t{0} << end;
    }
  }
  pieces_ = pes_;
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
