#pragma once

#include "firmware/cn/chip/poly_memory.hpp"
#include "firmware/cn/language/vec3.hpp"

namespace cn {

/// A variable of type T at the same SRAM address in every PE, for the current strip: `word` is the strip's
/// word that holds it, `shift` the bits below it. A record's fields are found from the record's address by
/// offsets that the compiler knows, so that most addresses take the simulator no instruction.
template <class T>
class PolyPlace {
  static_assert(sizeof(T) == 4 || sizeof(T) == 8, "a narrower write would reach its neighbour in the word");

 public:
  /// @param record_bytes address of the record, a multiple of 8
  /// @param field_bytes offset of the variable in the record
  PolyPlace(int record_bytes, int field_bytes)
      : word_(strip_word(record_bytes) + std::size_t(unsigned(field_bytes) / 8) * kStripLanes),
        shift_(static_cast<int>(unsigned(field_bytes) % 8 * 8)) {}
  explicit PolyPlace(int offset_bytes)
      : word_(strip_word(sizeof(T) == 8 ? offset_bytes : offset_bytes & ~7)),
        shift_(sizeof(T) == 8 ? 0 : static_cast<int>(unsigned(offset_bytes) % 8 * 8)) {}

  poly<T> read() const {
    if constexpr (sizeof(T) == 8) {
      return poly<T>(load_lanes<Lane>(word_));
    } else {
      const auto words = load_lanes<std::uint64_t>(word_);
      if constexpr (std::is_same_v<T, float>) {
        return poly<T>(each_lane<float>([&](int i) {
          const auto bits = static_cast<std::uint32_t>(words[i] >> shift_);
          float value;
          std::memcpy(&value, &bits, sizeof(value));
          return value;
        }));
      } else {
        return poly<T>(wrap_lanes<T>(each_chunk<Lane>(
            [&](int i) { return reinterpret_cast<typename Lanes<Lane>::Chunk>(words.chunk[i] >> shift_); })));
      }
    }
  }

  /// Writes in enabled PEs only.
  void write(const poly<T>& value) const {
    if constexpr (sizeof(T) == 8) {
      store_lanes(word_, select_lanes(strip.enabled, value.lanes(), load_lanes<Lane>(word_)));
    } else {
      const auto old_words = load_lanes<std::uint64_t>(word_);
      const std::uint64_t kept = ~(std::uint64_t{0xffffffffu} << shift_);
      const Lanes<std::uint64_t> new_words = words_of(value);
      const auto placed = each_chunk<std::uint64_t>(
          [&](int i) { return (old_words.chunk[i] & kept) | (new_words.chunk[i] << shift_); });
      store_lanes(word_, select_lanes(strip.enabled, placed, old_words));
    }
  }

 private:
  using Lane = typename poly<T>::Lane;

  /// Finds the strip's word. A strip has as many PEs as a word has bytes, so the address needs no division.
  static std::uint64_t* strip_word(int offset_bytes) {
    static_assert(kStripLanes == 8);
    return strip.words + std::size_t(unsigned(offset_bytes));
  }

  /// Returns the bits of a narrow variable, with zeros above.
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

  std::uint64_t* word_;
  int shift_;
};

/// A variable of type T at the same SRAM address in every PE. Reading and writing it are SRAM accesses. A
/// write changes enabled PEs only.
template <class T>
struct PolyField {
  int offset_bytes = 0;

  poly<T> read() const { return read_at(PolyPlace<T>(offset_bytes), offset_bytes); }
  void write(const poly<T>& value) const { write_at(PolyPlace<T>(offset_bytes), offset_bytes, value); }

 private:
  template <class>
  friend class PolyPointer;
  static constexpr int kBytes = static_cast<int>(sizeof(T));
  static constexpr std::uint64_t kWords = (sizeof(T) + 3) / 4;

  static poly<T> read_at(const PolyPlace<T>& place, int offset_bytes) {
    issue(InstructionClass::sram, kWords);
    observe_sram(Access::read, {offset_bytes, kBytes});
    return place.read();
  }
  static void write_at(const PolyPlace<T>& place, int offset_bytes, const poly<T>& value) {
    issue(InstructionClass::sram, kWords);
    observe_sram(Access::write, {offset_bytes, kBytes});
    place.write(value);
  }
};

/// A pointer to a Record in poly SRAM, at a multiple of 8. Fields are named by member pointer:
/// `ray.get(&RayRecord::origin)`. Records are plain structs of 4- and 8-byte members (and vec3<double>) with
/// the same layout in mono memory.
template <class Record>
class PolyPointer {
 public:
  PolyPointer() = default;
  explicit PolyPointer(PolySpan span) : offset_bytes_(span.offset_bytes) {}
  explicit PolyPointer(int offset_bytes) : offset_bytes_(offset_bytes) {}

  static constexpr int size_bytes() { return static_cast<int>(sizeof(Record)); }
  PolySpan span() const { return {offset_bytes_, size_bytes()}; }

  /// Returns a pointer to the index-th record of an array that starts here.
  PolyPointer operator[](int index) const { return PolyPointer(offset_bytes_ + index * size_bytes()); }

  /// Returns a pointer to a record that is a member of this one.
  template <class Part>
  PolyPointer<Part> part(Part Record::*member) const {
    return PolyPointer<Part>(offset_bytes_ + offset_of(member));
  }

  template <class T>
  PolyField<T> field(T Record::*member) const {
    return {offset_bytes_ + offset_of(member)};
  }

  template <class T>
  poly<T> get(T Record::*member) const {
    return read<T>(offset_of(member));
  }
  template <class T>
  vec3<poly<T>> get(vec3<T> Record::*member) const {
    const int offset = offset_of(member);
    constexpr int kSize = static_cast<int>(sizeof(T));
    return {read<T>(offset), read<T>(offset + kSize), read<T>(offset + 2 * kSize)};
  }

  template <class T>
  void set(T Record::*member, const poly<T>& value) const {
    write<T>(offset_of(member), value);
  }
  template <class T>
  void set(vec3<T> Record::*member, const vec3<poly<T>>& value) const {
    const int offset = offset_of(member);
    constexpr int kSize = static_cast<int>(sizeof(T));
    write<T>(offset, value.x);
    write<T>(offset + kSize, value.y);
    write<T>(offset + 2 * kSize, value.z);
  }

 private:
  template <class T>
  poly<T> read(int field_bytes) const {
    return PolyField<T>::read_at(PolyPlace<T>(offset_bytes_, field_bytes), offset_bytes_ + field_bytes);
  }
  template <class T>
  void write(int field_bytes, const poly<T>& value) const {
    PolyField<T>::write_at(PolyPlace<T>(offset_bytes_, field_bytes), offset_bytes_ + field_bytes, value);
  }

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
