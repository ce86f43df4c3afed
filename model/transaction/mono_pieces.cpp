#include "model/transaction/mono_pieces.hpp"

#include <algorithm>
#include <cstring>
#include <numeric>

namespace model {
namespace {

/// Packets of `bytes` bytes that begin at the start of a packet.
std::uint64_t packets_of(std::uint64_t bytes, const Divisor& packet) {
  return packet.quotient(bytes + packet.value() - 1);
}

/// Bytes of the packets that a piece needs wherever it lies.
std::uint64_t whole_packets(std::uint64_t bytes, const Divisor& packet) {
  return packets_of(bytes, packet) * packet.value();
}

/// The address after the last byte; beyond all memory when there is no such address.
cn::MonoAddress end_of(cn::MonoAddress address, std::uint64_t bytes) {
  return address + bytes < address ? ~cn::MonoAddress{0} : address + bytes;
}

bool is_misaligned(cn::MonoAddress address, std::uint64_t bytes, std::uint64_t packets_bytes,
                   const Divisor& packet) {
  return (address % 8 != 0) | (packet.remainder(address) + bytes > packets_bytes);
}

constexpr int kWordLanes = 64;
constexpr unsigned kAllLanes = (1u << cn::kStripLanes) - 1;

/// The enable bits of PEs first_pe .. first_pe + 63 below `num_pes`.
std::uint64_t enabled_word(const cn::LaneMask& enabled, int first_pe, int num_pes) {
  const int strips = std::min(kWordLanes, num_pes - first_pe) / cn::kStripLanes;
  std::uint64_t word = 0;
  for (int strip = 0; strip < strips; ++strip)
    word |= std::uint64_t{enabled.strip_bits(first_pe / cn::kStripLanes + strip)}
            << (strip * cn::kStripLanes);
  return word;
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
  if (transfer.mono.by_pe != nullptr) {
    by_pe_.resize(std::size_t(num_pes));
    for (int first_pe = 0; first_pe < num_pes; first_pe += cn::kStripLanes)
      std::memcpy(&by_pe_[std::size_t(first_pe)], transfer.mono.strip(first_pe),
                  cn::kStripLanes * sizeof(cn::MonoAddress));
  }
  enabled_ = transfer.enabled;
  bytes_per_pe_ = transfer.poly.size_bytes;
  pes_ = pieces_ = misaligned_ = 0;
  packets_ = end_ = 0;
  runs_.count_ = 0;
  if (runs_.storage_.size() < std::size_t(num_pes)) runs_.storage_.resize(std::size_t(num_pes));
  if (!describe_packed_array(num_pes, rules)) describe_each(num_pes, rules);
}

void MonoPieces::append_run(cn::MonoAddress address, std::uint64_t bytes, const Divisor& packet_bytes) {
  runs_.storage_[runs_.count_++] = {address, bytes};
  packets_ += packets_of(bytes, packet_bytes);
  end_ = std::max(end_, end_of(address, bytes));
}

const MonoPieces::MisalignedPattern& MonoPieces::pattern(const Rules& rules) {
  const Divisor& packet = rules.packet_bytes;
  const bool packets_are_words = packet.value() % 8 == 0;
  const std::uint64_t whole = packets_are_words ? packet.value() : std::lcm(packet.value(), std::uint64_t{8});
  const std::uint64_t offset = packets_are_words ? packet.remainder(first_) : first_ % whole;
  patterns_.resize(kKnownPatterns);
  MisalignedPattern& pattern = patterns_[(offset / 8 + stride_bytes_ / 8 * 5) % kKnownPatterns];
  if (pattern.offset == offset && pattern.bytes == stride_bytes_) return pattern;

  pattern = {offset, stride_bytes_, false, 0};
  const std::uint64_t period = whole / std::gcd(whole, stride_bytes_);
  pattern.repeats = kWordLanes % period == 0;
  const std::uint64_t packets_bytes = whole_packets(stride_bytes_, packet);
  for (std::uint64_t piece = 0; pattern.repeats && piece < kWordLanes; ++piece)
    if (is_misaligned(offset + piece * stride_bytes_, stride_bytes_, packets_bytes, packet))
      pattern.word |= std::uint64_t{1} << piece;
  return pattern;
}

/// An array without gaps between its pieces, whichever PEs take part: runs are runs of enable bits.
bool MonoPieces::describe_packed_array(int num_pes, const Rules& rules) {
  if (!by_pe_.empty() || bytes_per_pe_ == 0 || stride_bytes_ != std::uint64_t(bytes_per_pe_)) return false;
  const MisalignedPattern& misaligned = pattern(rules);
  if (!misaligned.repeats) return false;
  int run_start = 0;
  int run_end = 0;
  const auto end_run = [&] {
    if (run_end > run_start)
      append_run(first_ + std::uint64_t(run_start) * stride_bytes_,
                 std::uint64_t(run_end - run_start) * stride_bytes_, rules.packet_bytes);
  };
  for (int first_pe = 0; first_pe < num_pes; first_pe += kWordLanes) {
    std::uint64_t bits = enabled_word(enabled_, first_pe, num_pes);
    pes_ += __builtin_popcountll(bits);
    misaligned_ += __builtin_popcountll(bits & misaligned.word);
    while (bits != 0) {
      const int start = __builtin_ctzll(bits);
      const std::uint64_t above = bits + (std::uint64_t{1} << start);  // 0 when the run reaches bit 63
      const int end = above == 0 ? kWordLanes : __builtin_ctzll(above);
      if (first_pe + start != run_end) {
        end_run();
        run_start = first_pe + start;
      }
      run_end = first_pe + end;
      bits &= above == 0 ? 0 : ~std::uint64_t{0} << end;
    }
  }
  end_run();
  pieces_ = pes_;
  return true;
}

/// Several passes over all pieces: a short loop for each question is several times faster than one loop for
/// all of them.
void MonoPieces::describe_each(int num_pes, const Rules& rules) {
  if (by_pe_.empty()) {
    collect(num_pes,
            [first = first_, stride = stride_bytes_](int pe) { return first + std::uint64_t(pe) * stride; });
  } else {
    collect(num_pes, [first = first_, by_pe = by_pe_.data()](int pe) { return first + by_pe[pe]; });
  }
  if (rules.consolidate_equal_addresses && !write()) consolidate();
  const auto bytes = std::uint64_t(bytes_per_pe_);
  const std::uint64_t packets_of_one = packets_of(bytes, rules.packet_bytes);
  const std::uint64_t packets_bytes = packets_of_one * rules.packet_bytes.value();
  const cn::MonoAddress* const address = addresses_.data();
  int misaligned = 0;
  cn::MonoAddress last = 0;
  for (int i = 0; i < pieces_; ++i) {
    misaligned += is_misaligned(address[i], bytes, packets_bytes, rules.packet_bytes);
    last = std::max(last, address[i]);
  }
  misaligned_ = misaligned;
  if (pieces_ > 0) end_ = end_of(last, bytes);
  Run* run = runs_.storage_.data();
  for (int i = 0; i < pieces_; ++run) {
    const int first = i;
    while (++i < pieces_ && address[i] == address[i - 1] + bytes) {
    }
    *run = {address[first], std::uint64_t(i - first) * bytes};
    packets_ += i - first == 1 ? packets_of_one : packets_of(run->bytes, rules.packet_bytes);
  }
  runs_.count_ = std::size_t(run - runs_.storage_.data());
}

/// Collects the addresses of all PEs that take part, in their order. A strip of which only some take part is
/// done without a branch for each PE, which could not be predicted.
template <class AddressOf>
void MonoPieces::collect(int num_pes, const AddressOf& address_of) {
  addresses_.resize(std::size_t(num_pes) + 1);  // one more, because the place after the last is written, too
  cn::MonoAddress* const addresses = addresses_.data();
  std::size_t pes = 0;
  for (int first_pe = 0; first_pe < num_pes; first_pe += cn::kStripLanes) {
    const unsigned bits = enabled_.strip_bits(first_pe / cn::kStripLanes);
    if (bits == kAllLanes) {
      for (int lane = 0; lane < cn::kStripLanes; ++lane) addresses[pes++] = address_of(first_pe + lane);
      continue;
    }
    for (int lane = 0; lane < cn::kStripLanes; ++lane) {
      addresses[pes] = address_of(first_pe + lane);
      pes += (bits >> lane) & 1u;
    }
  }
  pes_ = pieces_ = static_cast<int>(pes);
}

/// Keeps the first of equal addresses.
void MonoPieces::consolidate() {
  seen_.clear();
  int kept = 0;
  for (int i = 0; i < pieces_; ++i)
    if (seen_.insert(addresses_[std::size_t(i)]))
      addresses_[std::size_t(kept++)] = addresses_[std::size_t(i)];
  pieces_ = kept;
}

}  // namespace model
