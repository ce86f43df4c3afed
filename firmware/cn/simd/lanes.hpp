#pragma once

#include <immintrin.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>

namespace cn {

/// Number of PEs that the simulator executes together, a strip. Eight doubles are one register of AVX-512,
/// two of AVX2 and four of SSE2. Wider strips gain nothing (tests/benchmarks/strip_width_benchmark.cpp), and
/// with narrow ones the array's width is a run-time number.
inline constexpr int kStripLanes = 8;

/// Native vector width of the level this file is compiled for.
#if defined(__AVX512F__)
inline constexpr std::size_t kNativeBytes = 64;
#elif defined(__AVX2__)
inline constexpr std::size_t kNativeBytes = 32;
#else
inline constexpr std::size_t kNativeBytes = 16;
#endif

/// The place of a lane's value among those of its strip. AVX2 narrows and widens vectors half by half. In
/// this order floats become words, and words floats, without crossing halves.
template <class T>
constexpr int place_of_lane(int lane) {
  constexpr bool halves_are_apart = kNativeBytes == 32 && sizeof(T) * kStripLanes == kNativeBytes;
  return halves_are_apart ? (lane & 1) | (lane & 2) << 1 | (lane & 4) >> 1 : lane;
}

/// One value for each PE of a strip, in as many native vectors as that takes. GCC splits vectors wider than
/// the machine's into scalars at comparisons and selects, hence the chunks.
template <class T>
struct Lanes {
  static constexpr std::size_t kBytes = kStripLanes * sizeof(T);
  static constexpr std::size_t kChunkBytes = kBytes < kNativeBytes ? kBytes : kNativeBytes;
  static constexpr int kChunks = static_cast<int>(kBytes / kChunkBytes);
  using Chunk __attribute__((vector_size(kChunkBytes))) = T;

  Chunk chunk[kChunks];

  T operator[](int lane) const {
    T value;
    std::memcpy(&value, reinterpret_cast<const char*>(this) + place_of_lane<T>(lane) * sizeof(T), sizeof(T));
    return value;
  }
  void set(int lane, T value) {
    std::memcpy(reinterpret_cast<char*>(this) + place_of_lane<T>(lane) * sizeof(T), &value, sizeof(T));
  }
};

/// Words of poly memory, to read and write whole rows. They have the element type and alignment of poly
/// memory, so that the compiler knows which of a kernel's other values a store cannot change.
using RowChunk __attribute__((vector_size(Lanes<std::uint64_t>::kChunkBytes), aligned(8))) = std::uint64_t;

template <class R, class F, std::size_t... i>
inline Lanes<R> each_chunk_of(F& f, std::index_sequence<i...>) {
  return {{f(std::integral_constant<int, int(i)>())...}};
}

/// Applies `f` chunk by chunk. Spelled out by index instead of a loop: GCC keeps a struct of vectors in
/// registers only if it never sees a variable index into it.
template <class R, class F>
inline Lanes<R> each_chunk(F&& f) {
  return each_chunk_of<R>(f, std::make_index_sequence<std::size_t(Lanes<R>::kChunks)>());
}

template <class R, class F, std::size_t... i>
inline void set_each_lane(Lanes<R>& result, F& f, std::index_sequence<i...>) {
  (result.set(int(i), f(int(i))), ...);
}

/// Applies `f` lane by lane, for operations without a vector form.
template <class R, class F>
inline Lanes<R> each_lane(F&& f) {
  Lanes<R> result;
  set_each_lane(result, f, std::make_index_sequence<std::size_t(kStripLanes)>());
  return result;
}

template <class T>
inline Lanes<T> broadcast(T value) {
  // Subtracting zero changes no number; adding it would turn -0.0 into 0.0.
  return each_chunk<T>([&](int) { return value - typename Lanes<T>::Chunk{}; });
}

/// Reads the same bits as another 8-byte type.
template <class To, class From>
inline Lanes<To> bit_cast_lanes(const Lanes<From>& from) {
  static_assert(sizeof(To) == 8 && sizeof(From) == 8);
  return each_chunk<To>([&](int i) { return reinterpret_cast<typename Lanes<To>::Chunk>(from.chunk[i]); });
}

/// @param row words of poly memory
template <class T>
inline Lanes<T> load_lanes(const void* row) {
  const auto* const chunks = static_cast<const RowChunk*>(row);
  return bit_cast_lanes<T>(each_chunk<std::uint64_t>([&](int i) { return chunks[i]; }));
}

template <class T>
inline void store_lanes(void* row, const Lanes<T>& value) {
  auto* const chunks = static_cast<RowChunk*>(row);
  const auto words = bit_cast_lanes<std::uint64_t>(value);
  each_chunk<std::uint64_t>([&](int i) { return chunks[i] = words.chunk[i]; });
}

/// Half of each 64-bit lane, read as a float.
enum class WordHalf : std::uint8_t { low, high };

template <WordHalf half>
inline Lanes<float> halves_of_words(const Lanes<std::uint64_t>& words) {
  return each_chunk<float>([&](int i) {
    using Chunk = Lanes<float>::Chunk;
#if defined(__AVX512F__)
    const auto wanted = half == WordHalf::low ? words.chunk[i] : words.chunk[i] >> 32;
    return Chunk(_mm512_maskz_cvtepi64_epi32(0xff, __m512i(wanted)));
#else
    constexpr int kOfEachPair = half == WordHalf::low ? 0x88 : 0xdd;
#if defined(__AVX2__)
    return Chunk(_mm256_shuffle_ps(__m256(words.chunk[2 * i]), __m256(words.chunk[2 * i + 1]), kOfEachPair));
#else
    return Chunk(_mm_shuffle_ps(__m128(words.chunk[2 * i]), __m128(words.chunk[2 * i + 1]), kOfEachPair));
#endif
#endif
  });
}

/// Returns 64-bit lanes with those halves.
inline Lanes<std::uint64_t> words_of_halves(const Lanes<float>& low, const Lanes<float>& high) {
  return each_chunk<std::uint64_t>([&](int i) {
    using Chunk = Lanes<std::uint64_t>::Chunk;
#if defined(__AVX512F__)
    const auto wide = [&](const Lanes<float>& half) {
      return Chunk(_mm512_maskz_cvtepu32_epi64(0xff, __m256i(half.chunk[i])));
    };
    return wide(low) | wide(high) << 32;
#elif defined(__AVX2__)
    const __m256 a = __m256(low.chunk[i / 2]);
    const __m256 b = __m256(high.chunk[i / 2]);
    return i % 2 == 0 ? Chunk(_mm256_unpacklo_ps(a, b)) : Chunk(_mm256_unpackhi_ps(a, b));
#else
    const __m128 a = __m128(low.chunk[i / 2]);
    const __m128 b = __m128(high.chunk[i / 2]);
    return i % 2 == 0 ? Chunk(_mm_unpacklo_ps(a, b)) : Chunk(_mm_unpackhi_ps(a, b));
#endif
  });
}

/// Rounds to the nearest float.
inline Lanes<float> narrow_lanes(const Lanes<double>& a) {
  return each_chunk<float>([&](int i) {
    using Chunk = Lanes<float>::Chunk;
#if defined(__AVX512F__)
    return Chunk(_mm512_maskz_cvtpd_ps(0xff, __m512d(a.chunk[i])));
#elif defined(__AVX2__)
    const __m256 in_order = _mm256_set_m128(_mm256_cvtpd_ps(__m256d(a.chunk[2 * i + 1])),
                                            _mm256_cvtpd_ps(__m256d(a.chunk[2 * i])));
    return Chunk(_mm256_permute4x64_pd(__m256d(in_order), 0xd8));  // place_of_lane
#else
    return Chunk(
        _mm_movelh_ps(_mm_cvtpd_ps(__m128d(a.chunk[2 * i])), _mm_cvtpd_ps(__m128d(a.chunk[2 * i + 1]))));
#endif
  });
}

/// Multiplies the low 32 bits of each lane. Spelled out because GCC would compute a full 64-bit product.
inline Lanes<std::uint64_t> multiply_low_words(const Lanes<std::uint64_t>& a, const Lanes<std::uint64_t>& b) {
  return each_chunk<std::uint64_t>([&](int i) {
    using Chunk = Lanes<std::uint64_t>::Chunk;
#if defined(__AVX512F__)
    return Chunk(_mm512_maskz_mul_epu32(0xff, __m512i(a.chunk[i]), __m512i(b.chunk[i])));
#elif defined(__AVX2__)
    return Chunk(_mm256_mul_epu32(__m256i(a.chunk[i]), __m256i(b.chunk[i])));
#else
    return Chunk(_mm_mul_epu32(__m128i(a.chunk[i]), __m128i(b.chunk[i])));
#endif
  });
}

}  // namespace cn
