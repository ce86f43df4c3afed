#pragma once

#include "firmware/cn/language/poly.hpp"

/// Floats by their bits: as halves of the words of SRAM, and as integers of the same order.
namespace cn {

/// Reads the float in one half of a word. Naming half of a register costs nothing.
inline poly<float> low_float(const poly<std::uint64_t>& word) {
  return poly<float>(halves_of_words<WordHalf::low>(word.lanes()));
}
inline poly<float> high_float(const poly<std::uint64_t>& word) {
  return poly<float>(halves_of_words<WordHalf::high>(word.lanes()));
}
inline poly<std::uint64_t> join_floats(const poly<float>& low, const poly<float>& high) {
  return poly<std::uint64_t>(words_of_halves(low.lanes(), high.lanes()));
}

/// Joins a float, as the upper half, and an integer to a word.
inline poly<std::uint64_t> join_words(const poly<float>& high, const poly<std::uint32_t>& low) {
  const Lanes<std::uint64_t> words = words_of_halves(broadcast(0.0f), high.lanes());
  return poly<std::uint64_t>(
      each_chunk<std::uint64_t>([&](int i) { return words.chunk[i] | low.lanes().chunk[i]; }));
}

/// Reads bits as a float.
inline poly<float> float_of_bits(const poly<std::uint32_t>& bits) {
  return poly<float>(halves_of_words<WordHalf::low>(bits.lanes()));
}

namespace float_bits_detail {

using Integers __attribute__((vector_size(sizeof(Lanes<float>::Chunk)))) = std::int32_t;

inline const Integers* integers(const Lanes<float>& a) {
  return reinterpret_cast<const Integers*>(a.chunk);
}

template <class Choose>
inline poly<float> choose(Choose&& of_chunk) {
  issue(InstructionClass::int32_alu);
  issue(InstructionClass::move);
  return poly<float>(each_chunk<float>([&](int i) { return Lanes<float>::Chunk(of_chunk(i)); }));
}

inline Lanes<double>::Chunk lesser(const Lanes<double>::Chunk& a, const Lanes<double>::Chunk& b) {
  using Chunk = Lanes<double>::Chunk;
#if defined(__AVX512F__)
  return Chunk(_mm512_maskz_min_pd(0xff, __m512d(a), __m512d(b)));
#elif defined(__AVX2__)
  return Chunk(_mm256_min_pd(__m256d(a), __m256d(b)));
#else
  return Chunk(_mm_min_pd(__m128d(a), __m128d(b)));
#endif
}
inline Lanes<double>::Chunk greater(const Lanes<double>::Chunk& a, const Lanes<double>::Chunk& b) {
  using Chunk = Lanes<double>::Chunk;
#if defined(__AVX512F__)
  return Chunk(_mm512_maskz_max_pd(0xff, __m512d(a), __m512d(b)));
#elif defined(__AVX2__)
  return Chunk(_mm256_max_pd(__m256d(a), __m256d(b)));
#else
  return Chunk(_mm_max_pd(__m128d(a), __m128d(b)));
#endif
}

template <class OfChunk>
inline poly<std::uint64_t> words(OfChunk&& of_chunk) {
  return poly<std::uint64_t>(bit_cast_lanes<std::uint64_t>(each_chunk<double>(of_chunk)));
}

}  // namespace float_bits_detail

/// Converts one of the four bytes of a float's bits, the lowest first, to a number.
template <int byte>
inline poly<float> byte_of(const poly<float>& bytes) {
  static_assert(byte >= 0 && byte < 4);
  issue(InstructionClass::int32_alu, byte == 0 || byte == 3 ? 1 : 2);  // shift, mask
  issue(InstructionClass::convert);
  return poly<float>(each_chunk<float>([&](int i) {
    using Chunk = Lanes<float>::Chunk;
#if defined(__AVX2__)
    const __m256i shifted = _mm256_srli_epi32(__m256i(bytes.lanes().chunk[i]), 8 * byte);
    return Chunk(_mm256_cvtepi32_ps(_mm256_and_si256(shifted, _mm256_set1_epi32(0xff))));
#else
    const __m128i shifted = _mm_srli_epi32(__m128i(bytes.lanes().chunk[i]), 8 * byte);
    return Chunk(_mm_cvtepi32_ps(_mm_and_si128(shifted, _mm_set1_epi32(0xff))));
#endif
  }));
}

/// Comparisons of the bits as signed integers, which the ALU does in half of the adder's time. Floats without
/// a sign bit compare in their own order. Floats with a sign bit are less than those, in reverse order; -0 is
/// the least.
inline poly<float> min_by_bits(const poly<float>& a, const poly<float>& b) {
  return float_bits_detail::choose([&](int i) {
#if defined(__AVX2__)
    return _mm256_min_epi32(__m256i(a.lanes().chunk[i]), __m256i(b.lanes().chunk[i]));
#else
    return _mm_min_epi32(__m128i(a.lanes().chunk[i]), __m128i(b.lanes().chunk[i]));
#endif
  });
}
inline poly<float> max_by_bits(const poly<float>& a, const poly<float>& b) {
  return float_bits_detail::choose([&](int i) {
#if defined(__AVX2__)
    return _mm256_max_epi32(__m256i(a.lanes().chunk[i]), __m256i(b.lanes().chunk[i]));
#else
    return _mm_max_epi32(__m128i(a.lanes().chunk[i]), __m128i(b.lanes().chunk[i]));
#endif
  });
}
inline mask at_most_by_bits(const poly<float>& a, const poly<float>& b) {
  issue(InstructionClass::int32_alu);
  return mask(compare_narrow<Comparison::less_or_equal>(float_bits_detail::integers(a.lanes()),
                                                        float_bits_detail::integers(b.lanes())));
}

/// Exchanges words where the second is the smaller. Each word must be that of a finite double that is not
/// negative; the simulator compares them as doubles.
inline void put_in_order(poly<std::uint64_t>& first, poly<std::uint64_t>& second) {
  issue(InstructionClass::int64_alu);
  issue(InstructionClass::move, 2);
  const auto a = bit_cast_lanes<double>(first.lanes());
  const auto b = bit_cast_lanes<double>(second.lanes());
  first.assign_all_lanes(
      float_bits_detail::words([&](int i) { return float_bits_detail::lesser(a.chunk[i], b.chunk[i]); }));
  second.assign_all_lanes(
      float_bits_detail::words([&](int i) { return float_bits_detail::greater(a.chunk[i], b.chunk[i]); }));
}

}  // namespace cn
