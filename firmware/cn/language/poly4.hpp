#pragma once

#include <array>
#include <utility>

#include "firmware/cn/chip/poly_memory.hpp"
#include "firmware/cn/language/poly.hpp"

namespace cn {

/// The vector instructions of an arithmetic type.
template <class T>
struct Vector4Traits;

template <>
struct Vector4Traits<double> {
  static constexpr auto kAdd = InstructionClass::fp64_add_vector4;
  static constexpr auto kMul = InstructionClass::fp64_mul_vector4;
  static constexpr auto kMultiplyAdd = InstructionClass::fp64_multiply_add_vector4;
};
template <>
struct Vector4Traits<float> {
  static constexpr auto kAdd = InstructionClass::fp32_add_vector4;
  static constexpr auto kMul = InstructionClass::fp32_mul_vector4;
  static constexpr auto kMultiplyAdd = InstructionClass::fp32_multiply_add_vector4;
};

/// Four poly variables of a PE that one vector instruction works on. Its elements follow each other through
/// the pipelined adder or multiplier, one a cycle, where scalar code waits for each result. Four doubles are
/// a quarter of a PE's 128 bytes of registers.
///
/// An operand may be mono: one value for all four elements, or one for each. The control unit loads it from
/// its data cache, with one instruction of its own stream for each value (InstructionClass::mono).
template <class T>
class poly4 {
 public:
  using Lane = typename poly<T>::Lane;

  poly4() = default;
  poly4(const poly<T>& a, const poly<T>& b, const poly<T>& c, const poly<T>& d) : element_{a, b, c, d} {}
  poly4(const poly4&) = default;
  poly4& operator=(const poly4&) = delete;

  /// Assigns in all PEs; charges no instruction (poly::assign_all_lanes).
  void assign_all_lanes(const poly4& other) {
    for (int i = 0; i < 4; ++i) element_[i].assign_all_lanes(other.element_[i]);
  }

  const poly<T>& operator[](int i) const { return element_[i]; }

 private:
  poly<T> element_[4];
};

template <class T>
using mono4 = std::array<T, 4>;

namespace vector4 {

template <class T>
inline auto chunk(const poly4<T>& a, int element, int i) {
  return a[element].lanes().chunk[i];
}
template <class T>
inline T chunk(const mono4<T>& a, int element, int) {
  return a[std::size_t(element)];
}
template <class T>
inline T chunk(T a, int, int) {
  return a;
}

template <class T>
inline void issue_operand(const poly4<T>&) {}
template <class T>
inline void issue_operand(const mono4<T>&) {
  issue(InstructionClass::mono, 4);
}
template <class T>
inline void issue_operand(T) {
  issue(InstructionClass::mono);
}

/// Applies `f(element, chunk)` to all four elements.
template <class T, class F>
inline poly4<T> each(F&& f) {
  using Lane = typename poly<T>::Lane;
  const auto element = [&](int e) { return poly<T>(each_chunk<Lane>([&](int i) { return f(e, i); })); };
  return {element(0), element(1), element(2), element(3)};
}

}  // namespace vector4

/// The operand type B is poly4<T>, T or mono4<T>, here and below.
template <class T, class B>
inline poly4<T> operator+(const poly4<T>& a, const B& b) {
  issue(Vector4Traits<T>::kAdd);
  vector4::issue_operand(b);
  return vector4::each<T>([&](int e, int i) { return vector4::chunk(a, e, i) + vector4::chunk(b, e, i); });
}

template <class T, class B>
inline poly4<T> operator-(const poly4<T>& a, const B& b) {
  issue(Vector4Traits<T>::kAdd);
  vector4::issue_operand(b);
  return vector4::each<T>([&](int e, int i) { return vector4::chunk(a, e, i) - vector4::chunk(b, e, i); });
}

template <class T, class B>
inline poly4<T> operator*(const poly4<T>& a, const B& b) {
  issue(Vector4Traits<T>::kMul);
  vector4::issue_operand(b);
  return vector4::each<T>([&](int e, int i) { return vector4::chunk(a, e, i) * vector4::chunk(b, e, i); });
}

/// Returns a * b + c. The multiplier hands each product to the adder; both round.
template <class T, class B>
inline poly4<T> multiply_add(const poly4<T>& a, const B& b, const poly4<T>& c) {
  issue(Vector4Traits<T>::kMultiplyAdd);
  vector4::issue_operand(b);
  return vector4::each<T>([&](int e, int i) {
    return vector4::chunk(a, e, i) * vector4::chunk(b, e, i) + vector4::chunk(c, e, i);
  });
}

/// Returns a * b - c.
template <class T, class B>
inline poly4<T> multiply_subtract(const poly4<T>& a, const B& b, const poly4<T>& c) {
  issue(Vector4Traits<T>::kMultiplyAdd);
  vector4::issue_operand(b);
  return vector4::each<T>([&](int e, int i) {
    return vector4::chunk(a, e, i) * vector4::chunk(b, e, i) - vector4::chunk(c, e, i);
  });
}

template <class T>
inline poly4<T> select(const mask& condition, const poly4<T>& if_set, const poly4<T>& otherwise) {
  return {select(condition, if_set[0], otherwise[0]), select(condition, if_set[1], otherwise[1]),
          select(condition, if_set[2], otherwise[2]), select(condition, if_set[3], otherwise[3])};
}

/// Four indices that the control unit knows: the same in all PEs.
using Indices4 = std::array<int, 4>;

inline Indices4 four_from(int first) {
  return {first, first + 1, first + 2, first + 3};
}

/// An array of 8-byte elements at the same address in every PE's SRAM, read and written four at a time.
template <class T>
class PolyArray {
  static_assert(sizeof(T) == 8);

 public:
  PolyArray() = default;
  explicit PolyArray(PolySpan span) : offset_bytes_(span.offset_bytes) {}

  poly4<T> load(const Indices4& at) const {
    issue(InstructionClass::sram_vector_load, 4 * kWords);
    for (const int index : at) observe_sram(Access::read, span(index));
    return {element(at[0], 0), element(at[1], 0), element(at[2], 0), element(at[3], 0)};
  }

  /// Returns what load(at) returns in the PE `steps` to the left (negative: right). Only the steps along the
  /// PE-to-PE path are charged. PEs beyond the end of the path keep their own value. Strips of PEs are
  /// executed one after the other, so the kernel must not write these places.
  poly4<T> swazzle(const Indices4& at, int steps) const {
    issue(InstructionClass::swazzle_vector4, static_cast<std::uint64_t>(steps < 0 ? -steps : steps));
    return {element(at[0], steps), element(at[1], steps), element(at[2], steps), element(at[3], steps)};
  }
  poly4<T> load_and_swazzle(const Indices4& at, int steps) const {
    load(at);
    return swazzle(at, steps);
  }

  /// Writes in enabled PEs only. A store does not overlap vector arithmetic, because a multiply-add leaves no
  /// register read port free.
  void store(const Indices4& at, const poly4<T>& value) const {
    issue(InstructionClass::sram, 4 * kWords);
    for (const int index : at) observe_sram(Access::write, span(index));
    for (int e = 0; e < 4; ++e) {
      std::uint64_t* const place = words(at[std::size_t(e)]);
      store_lanes(place, select_lanes(strip.enabled, value[e].lanes(), load_lanes<Lane>(place)));
    }
  }

 private:
  template <class>
  friend class VectorStream;
  using Lane = typename poly<T>::Lane;
  static constexpr std::uint64_t kWords = 2;

  PolySpan span(int index) const { return {offset_bytes_ + index * int{sizeof(T)}, int{sizeof(T)}}; }
  std::uint64_t* words(int index) const {
    return strip.words + std::size_t(unsigned(offset_bytes_ / 8 + index)) * kStripLanes;
  }
  std::uint64_t word_of(int index, int pe) const {
    const std::ptrdiff_t strips = pe / kStripLanes - strip.first_pe / kStripLanes;
    return words(index)[strips * std::ptrdiff_t(strip.to_next_strip) + pe % kStripLanes];
  }
  poly<T> element(int index, int steps) const {
    if (steps == 0) return poly<T>(load_lanes<Lane>(words(index)));
    const auto travelled = each_lane<std::uint64_t>([&](int lane) {
      const int pe = strip.first_pe + lane;
      const int from = pe - steps >= 0 && pe - steps < strip.num_pes ? pe - steps : pe;
      observe_travel(index, from, lane);
      return word_of(index, from);
    });
    return poly<T>(bit_cast_lanes<Lane>(travelled));
  }

  /// Tells the observer, if there is one, that an enabled PE receives what another PE reads.
  void observe_travel(int index, int from_pe, int to_lane) const {
    if constexpr (kObservedSram) {
      if (strip.observer == nullptr || (mask_bits(strip.enabled) >> to_lane & 1) == 0) return;
      strip.observer->touches_poly(Access::read, span(index), from_pe / kStripLanes * kStripLanes,
                                   1u << from_pe % kStripLanes);
    }
  }

  int offset_bytes_ = 0;
};

/// Vectors that travel down the PE-to-PE path in registers, one PE a step. The path is a line. Behind the
/// vectors that its PEs start with come those that its last `feeders` PEs hold in `fed`, PE by PE and place
/// after place, so that the PEs never run out. Feeders themselves work with no vector.
template <class T>
class VectorStream {
 public:
  /// @param own_at first of the four elements that each PE but the feeders starts with
  VectorStream(const PolyArray<T>& own, int own_at, const PolyArray<T>& fed, int fed_at, int feeders)
      : own_(own), own_at_(own_at), fed_(fed), fed_at_(fed_at), feeders_(feeders) {}

  /// Loads in the feeders only; call it before each `feeders` steps.
  void feed() const {
    issue(InstructionClass::enable, 2);
    issue(InstructionClass::sram_vector_load, 4 * PolyArray<T>::kWords);
  }

  /// Returns what the path has brought after that many steps. Ask for 0, 1, 2, ... steps in order: 0 steps
  /// are a load from `own`, each further step is one along the path. A kernel may store to the places of
  /// `own` after its last call: strips are executed in the order in which vectors leave them.
  poly4<T> after(int steps) const {
    if (steps == 0) {
      issue(InstructionClass::sram_vector_load, 4 * PolyArray<T>::kWords);
    } else {
      issue(InstructionClass::swazzle_vector4);
    }
    return {element(0, steps), element(1, steps), element(2, steps), element(3, steps)};
  }

 private:
  using Lane = typename poly<T>::Lane;

  poly<T> element(int element, int steps) const {
    observe_sources(element, steps);
    const int first_feeder = strip.num_pes - feeders_;
    const auto brought = each_lane<std::uint64_t>([&](int lane) -> std::uint64_t {
      const int pe = strip.first_pe + lane;
      if (pe >= first_feeder) return 0;
      if (pe + steps < first_feeder) return own_.word_of(own_at_ + element, pe + steps);
      const int behind = pe + steps - first_feeder;
      return fed_.word_of(fed_at_ + behind / feeders_ * 4 + element, first_feeder + behind % feeders_);
    });
    return poly<T>(bit_cast_lanes<Lane>(brought));
  }

  void observe_sources(int element, int steps) const {
    if constexpr (kObservedSram) {
      const int first_feeder = strip.num_pes - feeders_;
      for (int lane = 0; lane < kStripLanes && strip.first_pe + lane < first_feeder; ++lane) {
        const int from = strip.first_pe + lane + steps;
        const int behind = from - first_feeder;
        if (behind < 0) {
          own_.observe_travel(own_at_ + element, from, lane);
        } else {
          fed_.observe_travel(fed_at_ + behind / feeders_ * 4 + element, first_feeder + behind % feeders_,
                              lane);
        }
      }
    }
  }

  PolyArray<T> own_;
  int own_at_;
  PolyArray<T> fed_;
  int fed_at_;
  int feeders_;
};

}  // namespace cn
