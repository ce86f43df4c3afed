#pragma once

#include "firmware/cn/poly_memory.hpp"
#include "firmware/cn/vec3.hpp"

namespace cn {

/// A variable of type T at the same SRAM address in every PE. Reading and writing it are SRAM accesses; a
/// write reaches enabled PEs only.
template <class T>
struct PolyField {
  static_assert(sizeof(T) == 4 || sizeof(T) == 8, "a narrower write would reach its neighbour in the word");
  int offset_bytes = 0;

  poly<T> read() const {
    issue(InstructionClass::sram, kWords);
    observe_sram(Access::read, {offset_bytes, kBytes});
    const void* const row = address();
    if constexpr (sizeof(T) == 8) {
      return poly<T>(load_lanes<Lane>(row));
    } else {
      const auto words = load_lanes<std::uint64_t>(row);
      if constexpr (std::is_same_v<T, float>) {
        return poly<T>(each_lane<float>([&](int i) {
          const auto bits = static_cast<std::uint32_t>(words[i] >> shift());
          float value;
          std::memcpy(&value, &bits, sizeof(value));
          return value;
        }));
      } else {
        const int bits = shift();
        return poly<T>(wrap_lanes<T>(each_chunk<Lane>(
            [&](int i) { return reinterpret_cast<typename Lanes<Lane>::Chunk>(words.chunk[i] >> bits); })));
      }
    }
  }

  void write(const poly<T>& value) const {
    issue(InstructionClass::sram, kWords);
    observe_sram(Access::write, {offset_bytes, kBytes});
    void* const row = address();
    if constexpr (sizeof(T) == 8) {
      store_lanes(row, select_lanes(strip.enabled, value.lanes(), load_lanes<Lane>(row)));
    } else {
      const auto old_words = load_lanes<std::uint64_t>(row);
      const std::uint64_t kept = ~(std::uint64_t{0xffffffffu} << shift());
      const int bits = shift();
      const Lanes<std::uint64_t> new_words = words_of(value);
      const auto placed = each_chunk<std::uint64_t>(
          [&](int i) { return (old_words.chunk[i] & kept) | (new_words.chunk[i] << bits); });
      store_lanes(row, select_lanes(strip.enabled, placed, old_words));
    }
  }

 private:
  using Lane = typename poly<T>::Lane;
  static constexpr int kBytes = static_cast<int>(sizeof(T));
  static constexpr std::uint64_t kWords = (sizeof(T) + 3) / 4;

  /// A narrow variable's bits, zero above.
  static Lanes<std::uint64_t> words_of(const poly<T>& value) {
    if constexpr (std::is_same_v<T, float>) {
      return each_lane<std::uint64_t>([&](int i) {
        const float lane = value.lanes()[i];
        std::uint32_t word;
        std::memcpy(&word, &lane, sizeof(word));
        return std::uint64_t{word};
      });
    } else {
      const auto lanes = bit_cast_lanes<std::uint64_t>(value.lanes());
      return each_chunk<std::uint64_t>([&](int i) { return lanes.chunk[i] & 0xffffffffu; });
    }
  }

  int shift() const { return static_cast<int>(8 * (unsigned(offset_bytes) % 8)); }
  std::uint64_t* address() const {
    // Unsigned: no address is negative, and the division is a shift.
    return strip.poly_words + std::size_t(unsigned(offset_bytes) / 8) * unsigned(strip.num_pes) +
           unsigned(strip.first_pe);
  }
};

/// A pointer to a Record in poly SRAM. Fields are named by member pointer: `ray.get(&RayRecord::origin)`.
/// Records are plain structs of 4- and 8-byte members (and vec3<double>), laid out alike in mono memory.
template <class Record>
class PolyPointer {
 public:
  PolyPointer() = default;
  explicit PolyPointer(PolySpan span) : offset_bytes_(span.offset_bytes) {}
  explicit PolyPointer(int offset_bytes) : offset_bytes_(offset_bytes) {}

  static constexpr int size_bytes() { return static_cast<int>(sizeof(Record)); }
  PolySpan span() const { return {offset_bytes_, size_bytes()}; }

  /// The index-th record of an array that starts here.
  PolyPointer operator[](int index) const { return PolyPointer(offset_bytes_ + index * size_bytes()); }

  template <class T>
  PolyField<T> field(T Record::*member) const {
    return {offset_bytes_ + offset_of(member)};
  }

  template <class T>
  poly<T> get(T Record::*member) const {
    return field(member).read();
  }
  template <class T>
  vec3<poly<T>> get(vec3<T> Record::*member) const {
    const int offset = offset_bytes_ + offset_of(member);
    constexpr int kSize = static_cast<int>(sizeof(T));
    return {PolyField<T>{offset}.read(), PolyField<T>{offset + kSize}.read(),
            PolyField<T>{offset + 2 * kSize}.read()};
  }

  template <class T>
  void set(T Record::*member, const poly<T>& value) const {
    field(member).write(value);
  }
  template <class T>
  void set(vec3<T> Record::*member, const vec3<poly<T>>& value) const {
    const int offset = offset_bytes_ + offset_of(member);
    constexpr int kSize = static_cast<int>(sizeof(T));
    PolyField<T>{offset}.write(value.x);
    PolyField<T>{offset + kSize}.write(value.y);
    PolyField<T>{offset + 2 * kSize}.write(value.z);
  }

 private:
  template <class T>
  static int offset_of(T Record::*member) {
    static_assert(sizeof(Record) % 8 == 0, "records are whole 8-byte words");
    static const Record probe{};
    return static_cast<int>(reinterpret_cast<const char*>(&(probe.*member)) -
                            reinterpret_cast<const char*>(&probe));
  }

  int offset_bytes_ = 0;
};

}  // namespace cn
