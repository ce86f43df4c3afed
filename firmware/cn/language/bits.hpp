#pragma once

#include "firmware/cn/language/poly.hpp"

namespace cn {

namespace bits_detail {

using Chunk = Lanes<std::uint64_t>::Chunk;

/// Reorders the bytes of each 16-byte part of a vector: `places` and `table` repeat every 16 bytes.
#if defined(__AVX512F__)
inline Chunk shuffle_bytes(Chunk table, Chunk places) {
  return Chunk(_mm512_shuffle_epi8(__m512i(table), __m512i(places)));
}
#elif defined(__AVX2__)
inline Chunk shuffle_bytes(Chunk table, Chunk places) {
  return Chunk(_mm256_shuffle_epi8(__m256i(table), __m256i(places)));
}
#else
inline Chunk shuffle_bytes(Chunk table, Chunk places) {
  return Chunk(_mm_shuffle_epi8(__m128i(table), __m128i(places)));
}
#endif

inline Chunk repeat(std::uint64_t low, std::uint64_t high) {
  Chunk chunk;
  for (std::size_t i = 0; i < kNativeBytes / 8; i += 2) {
    chunk[i] = low;
    chunk[i + 1] = high;
  }
  return chunk;
}

}  // namespace bits_detail

/// Reverses the order of the 32 bits. A PE exchanges neighbours, pairs, nibbles and bytes by masks and
/// shifts, five operations each, and names its two 16-bit words in the other order.
inline poly<std::uint32_t> reverse_bits(const poly<std::uint32_t>& a) {
  using namespace bits_detail;
  issue(InstructionClass::int32_alu, 20);
  // The simulator looks nibbles up.
  const Chunk reversed = repeat(0x0e060a020c040800u, 0x0f070b030d050901u);
  const Chunk reversed_high = reversed << 4;
  const Chunk opposite_bytes = repeat(0x8080808000010203u, 0x8080808008090a0bu);
  constexpr std::uint64_t kLowNibbles = 0x0f0f0f0f;
  return poly<std::uint32_t>(each_chunk<std::uint64_t>([&](int i) {
    const Chunk low = a.lanes().chunk[i] & kLowNibbles;
    const Chunk high = (a.lanes().chunk[i] >> 4) & kLowNibbles;
    const Chunk bytes = shuffle_bytes(reversed_high, low) | shuffle_bytes(reversed, high);
    return shuffle_bytes(bytes, opposite_bytes);
  }));
}

}  // namespace cn
