#pragma once

#include "firmware/cn/chip/poly_memory.hpp"
#include "firmware/cn/language/poly.hpp"

/// Poly memory through poly pointers: each PE reads or writes at an address of its own in its own SRAM. An
/// access costs what an access at the same address in all PEs costs. Computing addresses is charged where it
/// is written.
namespace cn {

namespace indexed_detail {

inline Lanes<std::uint64_t> lane_numbers() {
  return each_lane<std::uint64_t>([](int i) { return std::uint64_t(i); });
}

/// The index in Strip::words of each enabled PE's word; 0 for the others, whose addresses may be anything.
inline Lanes<std::uint64_t> word_index(const poly<std::int32_t>& address) {
  const auto bytes = bit_cast_lanes<std::uint64_t>(address.lanes());
  const auto lane = lane_numbers();
  static_assert(kStripLanes == 8, "lanes a word and bytes a word cancel");
  const auto index =
      each_chunk<std::uint64_t>([&](int i) { return (bytes.chunk[i] & ~std::uint64_t{7}) + lane.chunk[i]; });
  return select_lanes(MaskLanes(strip.enabled), index, broadcast(std::uint64_t{0}));
}

/// Gathers each lane's own words by scalar loads, because a gather instruction takes several times as many
/// operations.
template <std::size_t... lane>
inline Lanes<std::uint64_t>::Chunk gather_chunk(const std::uint64_t* const* pointer, std::size_t offset,
                                                std::index_sequence<lane...>) {
  return Lanes<std::uint64_t>::Chunk{pointer[lane][offset]...};
}

struct LanePointers {
  const std::uint64_t* lane[kStripLanes];

  explicit LanePointers(const Lanes<std::uint64_t>& index) {
    for (int i = 0; i < kStripLanes; ++i) lane[i] = strip.words + index[i];
  }
  Lanes<std::uint64_t> gather(std::size_t offset) const {
    constexpr std::size_t kInChunk = Lanes<std::uint64_t>::kChunkBytes / sizeof(std::uint64_t);
    return each_chunk<std::uint64_t>([&](int i) {
      return gather_chunk(lane + std::size_t(i) * kInChunk, offset, std::make_index_sequence<kInChunk>());
    });
  }
};

/// The shift, in bits, of a 4-byte variable in its 8-byte word.
inline Lanes<std::uint64_t> shift_in_word(const poly<std::int32_t>& address) {
  const auto bytes = bit_cast_lanes<std::uint64_t>(address.lanes());
  return each_chunk<std::uint64_t>([&](int i) { return (bytes.chunk[i] & 4) << 3; });
}

inline void observe(Access access, const poly<std::int32_t>& address, int bytes) {
  if constexpr (kObservedSram) {
    if (strip.observer == nullptr) return;
    const std::uint32_t enabled = mask_bits(strip.enabled);
    for (int lane = 0; lane < kStripLanes; ++lane)
      if ((enabled >> lane & 1) != 0)
        strip.observer->touches_poly(access, {static_cast<int>(address.lanes()[lane]), bytes}, strip.first_pe,
                                     1u << lane);
  }
}

}  // namespace indexed_detail

/// @param address in bytes, a multiple of sizeof(T) within the SRAM on every enabled PE; disabled PEs get an
/// arbitrary value
template <class T>
inline poly<T> load_at(const poly<std::int32_t>& address) {
  static_assert(sizeof(T) == 8 || (sizeof(T) == 4 && std::is_integral_v<T>));
  issue(InstructionClass::sram, sizeof(T) / 4);
  indexed_detail::observe(Access::read, address, sizeof(T));
  const Lanes<std::uint64_t> words =
      indexed_detail::LanePointers(indexed_detail::word_index(address)).gather(0);
  using Lane = typename poly<T>::Lane;
  if constexpr (sizeof(T) == 8) {
    return poly<T>(bit_cast_lanes<Lane>(words));
  } else {
    const auto shift = indexed_detail::shift_in_word(address);
    const auto low = each_chunk<std::uint64_t>([&](int i) { return words.chunk[i] >> shift.chunk[i]; });
    return poly<T>(wrap_lanes<T>(bit_cast_lanes<Lane>(low)));
  }
}

/// Writes in enabled PEs only; for `address` see load_at.
inline void store_at(const poly<std::int32_t>& address, const poly<std::uint64_t>& value) {
  issue(InstructionClass::sram, 2);
  indexed_detail::observe(Access::write, address, 8);
  const Lanes<std::uint64_t> index = indexed_detail::word_index(address);
  for (std::uint32_t lanes = mask_bits(strip.enabled); lanes != 0; lanes &= lanes - 1) {
    const int lane = __builtin_ctz(lanes);
    strip.words[index[lane]] = value.lanes()[lane];
  }
}

/// A record at an address of its own in each PE.
class IndexedRecord {
 public:
  /// @param address see load_at; a multiple of 8
  explicit IndexedRecord(const poly<std::int32_t>& address)
      : address_(address), pointers_(indexed_detail::word_index(address)) {}

  /// Loads the 8 bytes at an offset that is the same for all PEs, a multiple of 8.
  template <class T>
  poly<T> load(int offset_bytes) const {
    static_assert(sizeof(T) == 8);
    issue(InstructionClass::sram, 2);
    observe(offset_bytes, 8);
    return poly<T>(bit_cast_lanes<typename poly<T>::Lane>(
        pointers_.gather(std::size_t(unsigned(offset_bytes) / 8) * kStripLanes)));
  }

  /// Returns for each PE the one of two loaded variables that its condition chooses. On the chip the
  /// condition is part of the address, so that the PE reads the right one at once and no instruction chooses.
  template <class T>
  static poly<T> chosen(const mask& condition, const poly<T>& if_set, const poly<T>& otherwise) {
    return poly<T>(select_lanes(condition.lanes(), if_set.lanes(), otherwise.lanes()));
  }

 private:
  void observe(int offset_bytes, int bytes) const {
    if constexpr (kObservedSram) {
      poly<std::int32_t> at(address_);
      at.assign_all_lanes(poly<std::int32_t>(each_chunk<std::int64_t>(
          [&](int i) { return address_.lanes().chunk[i] + std::int64_t{offset_bytes}; })));
      indexed_detail::observe(Access::read, at, bytes);
    }
  }

  poly<std::int32_t> address_;
  indexed_detail::LanePointers pointers_;
};

/// Shifts by each PE's own amount, 0 to 63. The ALU shifts by one fixed amount a pass, so this takes a
/// conditional pass for each bit of the amount.
inline void issue_variable_shift() {
  issue(InstructionClass::int64_alu, 6);
  issue(InstructionClass::move, 6);
}
inline poly<std::uint64_t> shift_left(const poly<std::uint64_t>& a, const poly<std::int32_t>& bits) {
  issue_variable_shift();
  const auto amount = bit_cast_lanes<std::uint64_t>(bits.lanes());
  return poly<std::uint64_t>(
      each_chunk<std::uint64_t>([&](int i) { return a.lanes().chunk[i] << (amount.chunk[i] & 63); }));
}
inline poly<std::uint64_t> shift_right(const poly<std::uint64_t>& a, const poly<std::int32_t>& bits) {
  issue_variable_shift();
  const auto amount = bit_cast_lanes<std::uint64_t>(bits.lanes());
  return poly<std::uint64_t>(
      each_chunk<std::uint64_t>([&](int i) { return a.lanes().chunk[i] >> (amount.chunk[i] & 63); }));
}

/// Returns the number of the highest bit that is set in a positive number: its exponent as a double.
inline poly<std::int32_t> highest_bit(const poly<std::uint32_t>& a) {
  const poly<std::uint64_t> bits = reinterpret<std::uint64_t>(convert<double>(a));
  issue(InstructionClass::int32_alu, 2);  // on the upper word
  return poly<std::int32_t>(bit_cast_lanes<std::int64_t>(
      each_chunk<std::uint64_t>([&](int i) { return (bits.lanes().chunk[i] >> 52) - 1023; })));
}

}  // namespace cn
