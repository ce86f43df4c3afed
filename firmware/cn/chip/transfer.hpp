#pragma once

#include <array>
#include <cstdint>

#include "firmware/cn/chip/label.hpp"
#include "firmware/cn/chip/lane_mask.hpp"
#include "firmware/cn/chip/mono_memory.hpp"
#include "firmware/cn/chip/mono_range.hpp"
#include "firmware/cn/chip/poly_memory.hpp"

namespace cn {

/// A hardware semaphore: a counter that PIO transfers, threads and the host signal and wait on.
struct Semaphore {
  int index = -1;
};

enum class Direction : std::uint8_t { mono_to_poly, poly_to_mono };

/// One programmed-I/O request: every enabled PE moves `poly.size_bytes` between its SRAM and its own place in
/// mono memory; `done` is signalled when all have.
struct Transfer {
  Direction direction = Direction::mono_to_poly;
  PolySpan poly;
  MonoPlaces mono;
  LaneMask enabled;
  Semaphore done;
  Label label{};
};

/// Returns the first enabled PE whose place is not `allowed(place)`, or -1.
template <class Allowed>
int first_pe_not(const Transfer& transfer, int num_pes, Allowed&& allowed) {
  for (int first_pe = 0; first_pe < num_pes; first_pe += kStripLanes) {
    const unsigned enabled = transfer.enabled.strip_bits(first_pe / kStripLanes);
    if (enabled == 0) continue;
    unsigned not_allowed = 0;
    for (int lane = 0; lane < kStripLanes; ++lane)
      not_allowed |= static_cast<unsigned>(!allowed(transfer.mono[first_pe + lane])) << lane;
    if ((not_allowed & enabled) != 0) return first_pe + __builtin_ctz(not_allowed & enabled);
  }
  return -1;
}

namespace transfer_detail {

/// For the bits of half a strip the words that are all ones.
inline constexpr int kHalf = kStripLanes / 2;
constexpr std::array<std::array<std::uint64_t, kHalf>, 1 << kHalf> make_words_of_bits() {
  std::array<std::array<std::uint64_t, kHalf>, 1 << kHalf> words{};
  for (unsigned bits = 0; bits < words.size(); ++bits)
    for (int i = 0; i < kHalf; ++i) words[bits][std::size_t(i)] = -std::uint64_t{(bits >> i) & 1u};
  return words;
}
inline constexpr auto kWordsOfBits = make_words_of_bits();

/// Whether all enabled PEs' offsets, counted from `first` on, are at most `latest`, which is below 2^63.
/// Borrows are gathered in sign bits, because branches on what each PE gives are slow.
inline bool are_at_most(const Transfer& transfer, int num_pes, std::uint64_t first, std::uint64_t latest) {
  std::array<std::uint64_t, kHalf> beyond{};
  for (int first_pe = 0; first_pe < num_pes; first_pe += kStripLanes) {
    const unsigned bits = transfer.enabled.strip_bits(first_pe / kStripLanes);
    if (bits == 0) continue;
    const MonoAddress* const offsets = transfer.mono.strip(first_pe);
    for (unsigned half = 0; half < 2; ++half) {
      const auto& enabled = kWordsOfBits[bits >> (half * kHalf) & ((1u << kHalf) - 1)];
      for (std::size_t i = 0; i < kHalf; ++i) {
        const std::uint64_t found = first + offsets[half * kHalf + i];
        beyond[i] |= ((latest - found) | found) & enabled[i];
      }
    }
  }
  return (beyond[0] | beyond[1] | beyond[2] | beyond[3]) >> 63 == 0;
}

}  // namespace transfer_detail

/// Whether what the enabled PEs move lies within `range`, whose size is below 2^63.
inline bool lies_within(const Transfer& transfer, int num_pes, const MonoRange& range) {
  const auto wanted = static_cast<std::uint64_t>(transfer.poly.size_bytes);
  const MonoPlaces& places = transfer.mono;
  if (places.by_pe == nullptr && places.stride_bytes <= range.bytes)  // all are between first and last
    if (range.contains(places[0], wanted) && range.contains(places[num_pes - 1], wanted)) return true;
  if (places.by_pe == nullptr || wanted > range.bytes)
    return first_pe_not(transfer, num_pes, [&](MonoAddress at) { return range.contains(at, wanted); }) < 0;
  return transfer_detail::are_at_most(transfer, num_pes, places.first - range.first, range.bytes - wanted);
}

/// Moves the bytes of a transfer; `mono` is the storage of mono address 0. Addresses and sizes are multiples
/// of 8 (checked by Machine).
void move_data(const Transfer& transfer, PolyMemory& poly, std::uint8_t* mono);

}  // namespace cn
