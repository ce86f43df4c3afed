#pragma once

#include "firmware/cn/simd/lanes.hpp"

namespace cn {

/// One condition for each PE of a strip. AVX-512 has registers for such bits; a condition held in lanes of
/// all ones or zero instead takes two more steps, there and back, at each use. Other levels have such lanes
/// only.
#if defined(__AVX512F__)

struct MaskLanes {
  __mmask8 bits;

  std::int64_t operator[](int lane) const { return -static_cast<std::int64_t>((bits >> lane) & 1); }
};

/// Returns lane i's condition as bit i.
inline std::uint32_t mask_bits(const MaskLanes& mask) {
  return mask.bits;
}
inline MaskLanes mask_from_bits(std::uint32_t bits) {
  return {static_cast<__mmask8>(bits)};
}

/// A condition in memory. It is not a byte, because a byte may alias everything: at each write, the compiler
/// would write out and read back all that it knows of the strip.
class StoredMask {
 public:
  StoredMask() = default;
  StoredMask(const MaskLanes& mask) : bits_(mask.bits) {}
  operator MaskLanes() const { return {static_cast<__mmask8>(bits_)}; }

 private:
  std::uint16_t bits_ = 0;
};

// Intrinsics, because GCC turns plain operators into a chain of comparisons, each under the mask of the one
// before and five cycles after it.
inline MaskLanes operator&(const MaskLanes& a, const MaskLanes& b) {
  return mask_from_bits(_kand_mask8(a.bits, b.bits));
}
inline MaskLanes operator|(const MaskLanes& a, const MaskLanes& b) {
  return mask_from_bits(_kor_mask8(a.bits, b.bits));
}
inline MaskLanes operator~(const MaskLanes& a) {
  return mask_from_bits(_knot_mask8(a.bits));
}

#else

struct MaskLanes : Lanes<std::int64_t> {};
using StoredMask = MaskLanes;

inline MaskLanes operator&(const MaskLanes& a, const MaskLanes& b) {
  return {each_chunk<std::int64_t>([&](int i) { return a.chunk[i] & b.chunk[i]; })};
}
inline MaskLanes operator|(const MaskLanes& a, const MaskLanes& b) {
  return {each_chunk<std::int64_t>([&](int i) { return a.chunk[i] | b.chunk[i]; })};
}
inline MaskLanes operator~(const MaskLanes& a) {
  return {each_chunk<std::int64_t>([&](int i) { return ~a.chunk[i]; })};
}

inline std::uint32_t mask_bits(const MaskLanes& mask) {
  std::uint32_t bits = 0;
  for (int i = 0; i < MaskLanes::kChunks; ++i) {
#if defined(__AVX2__)
    bits |= static_cast<std::uint32_t>(_mm256_movemask_pd(__m256d(mask.chunk[i]))) << (4 * i);
#else
    bits |= static_cast<std::uint32_t>(_mm_movemask_pd(__m128d(mask.chunk[i]))) << (2 * i);
#endif
  }
  return bits;
}
inline MaskLanes mask_from_bits(std::uint32_t bits) {
  const auto lane_bit = each_lane<std::int64_t>([](int i) { return std::int64_t{1} << i; });
  const std::int64_t broadcast_bits = bits;
  return {each_chunk<std::int64_t>(
      [&](int i) { return (lane_bit.chunk[i] & (Lanes<std::int64_t>::Chunk{} + broadcast_bits)) != 0; })};
}

#endif

enum class Comparison : std::uint8_t { equal, not_equal, less, less_or_equal };

template <Comparison comparison, class V>
inline auto compare_values(const V& a, const V& b) {
  if constexpr (comparison == Comparison::equal) return a == b;
  if constexpr (comparison == Comparison::not_equal) return a != b;
  if constexpr (comparison == Comparison::less) return a < b;
  if constexpr (comparison == Comparison::less_or_equal) return a <= b;
}

#if defined(__AVX512F__)
/// Compares NaN as the operators do: only != holds.
template <Comparison comparison>
inline MaskLanes compare_chunks(__m512d a, __m512d b) {
  constexpr int kPredicate = comparison == Comparison::equal       ? _CMP_EQ_OQ
                             : comparison == Comparison::not_equal ? _CMP_NEQ_UQ
                             : comparison == Comparison::less      ? _CMP_LT_OS
                                                                   : _CMP_LE_OS;
  return mask_from_bits(_mm512_cmp_pd_mask(a, b, kPredicate));
}
template <Comparison comparison, bool is_signed>
inline MaskLanes compare_integer_chunks(__m512i a, __m512i b) {
  constexpr auto kPredicate = comparison == Comparison::equal       ? _MM_CMPINT_EQ
                              : comparison == Comparison::not_equal ? _MM_CMPINT_NE
                              : comparison == Comparison::less      ? _MM_CMPINT_LT
                                                                    : _MM_CMPINT_LE;
  if constexpr (is_signed) return mask_from_bits(_mm512_cmp_epi64_mask(a, b, kPredicate));
  return mask_from_bits(_mm512_cmp_epu64_mask(a, b, kPredicate));
}
#endif

/// Compares lanes of 32 bits as their type does.
template <Comparison comparison, class V>
inline MaskLanes compare_narrow(const V* a, const V* b) {
#if defined(__AVX512F__)
  const auto lanes = compare_values<comparison>(a[0], b[0]);
  return mask_from_bits(_mm256_movepi32_mask(__m256i(lanes)));
#else
  const auto lanes =
      each_chunk<float>([&](int i) { return Lanes<float>::Chunk(compare_values<comparison>(a[i], b[i])); });
  return {bit_cast_lanes<std::int64_t>(words_of_halves(lanes, lanes))};
#endif
}

inline Lanes<float> select_narrow(const MaskLanes& mask, const Lanes<float>& if_set,
                                  const Lanes<float>& otherwise) {
#if defined(__AVX512F__)
  return {{Lanes<float>::Chunk(_mm256_mask_blend_ps(static_cast<__mmask8>(mask.bits),
                                                    __m256(otherwise.chunk[0]), __m256(if_set.chunk[0])))}};
#else
  const auto narrow = halves_of_words<WordHalf::low>(bit_cast_lanes<std::uint64_t>(mask));
  using Bits __attribute__((vector_size(sizeof(Lanes<float>::Chunk)))) = std::int32_t;
  return each_chunk<float>(
      [&](int i) { return Bits(narrow.chunk[i]) ? if_set.chunk[i] : otherwise.chunk[i]; });
#endif
}

template <Comparison comparison, class T>
inline MaskLanes compare_lanes(const Lanes<T>& a, const Lanes<T>& b) {
  if constexpr (std::is_same_v<T, float>) {
    return compare_narrow<comparison>(a.chunk, b.chunk);
  } else {
#if defined(__AVX512F__)
    if constexpr (std::is_floating_point_v<T>) {
      return compare_chunks<comparison>(__m512d(a.chunk[0]), __m512d(b.chunk[0]));
    } else {
      return compare_integer_chunks<comparison, std::is_signed_v<T>>(__m512i(a.chunk[0]),
                                                                     __m512i(b.chunk[0]));
    }
#else
    return {each_chunk<std::int64_t>([&](int i) {
      return Lanes<std::int64_t>::Chunk(compare_values<comparison>(a.chunk[i], b.chunk[i]));
    })};
#endif
  }
}

template <class T>
inline Lanes<T> select_lanes(const MaskLanes& mask, const Lanes<T>& if_set, const Lanes<T>& otherwise) {
  if constexpr (std::is_same_v<T, float>) {
    return select_narrow(mask, if_set, otherwise);
  } else {
#if defined(__AVX512F__)
    return each_chunk<T>([&](int i) {
      return typename Lanes<T>::Chunk(_mm512_mask_blend_epi64(
          static_cast<__mmask8>(mask.bits), __m512i(otherwise.chunk[i]), __m512i(if_set.chunk[i])));
    });
#else
    return each_chunk<T>([&](int i) { return mask.chunk[i] ? if_set.chunk[i] : otherwise.chunk[i]; });
#endif
  }
}

}  // namespace cn
