// Built once for each x86-64 level, whose name is the namespace of move_data.

#include <immintrin.h>

#include <cstdint>
#include <cstring>

#include "firmware/cn/chip/transfer.hpp"

namespace cn {
namespace {

constexpr unsigned kAllLanes = (1u << kStripLanes) - 1;

/// Returns `if_set` or `otherwise` by arithmetic: GCC would turn ?: into branches, which the processor could
/// not predict here.
template <class T>
T* chosen(unsigned lanes, int lane, T* if_set, T* otherwise) {
  const auto bits = reinterpret_cast<std::uintptr_t>(otherwise);
  const std::uintptr_t mask = -std::uintptr_t{(lanes >> lane) & 1u};
  return reinterpret_cast<T*>(bits ^ ((bits ^ reinterpret_cast<std::uintptr_t>(if_set)) & mask));
}

/// Places of a strip's pieces that lie side by side in an array.
class PlacesInArray {
 public:
  static constexpr bool kAnywhere = false;

  PlacesInArray(const MonoPlaces& mono, int first_pe, unsigned /*enabled*/, std::uint8_t* memory)
      : first_(memory + mono[first_pe]), stride_bytes_(mono.stride_bytes) {}
  std::uint8_t* operator[](int lane) const { return first_ + std::uint64_t(unsigned(lane)) * stride_bytes_; }

 private:
  std::uint8_t* first_;
  std::uint64_t stride_bytes_;
};

/// Places that each PE gives. Disabled PEs may hold any address; they get an enabled one's instead, so that
/// all addresses are valid.
class PlacesOfEach {
 public:
  static constexpr bool kAnywhere = true;

  PlacesOfEach(const MonoPlaces& mono, int first_pe, unsigned enabled, std::uint8_t* memory) {
    const MonoAddress* const address = mono.strip(first_pe);
    std::uint8_t* const first = memory + mono.first;
    std::uint8_t* const valid = first + address[__builtin_ctz(enabled)];
    for (int lane = 0; lane < kStripLanes; ++lane)
      place_[lane] = chosen(enabled, lane, first + address[lane], valid);
  }
  std::uint8_t* operator[](int lane) const { return place_[lane]; }

 private:
  std::uint8_t* place_[kStripLanes];
};

/// The places of `Places`, but disabled PEs store to a scratch place. An unconditional store is cheaper than
/// a branch that the processor cannot predict.
class PlacesOrScratch {
 public:
  template <class Places>
  PlacesOrScratch(const Places& places, unsigned enabled, std::uint8_t* scratch) {
    for (int lane = 0; lane < kStripLanes; ++lane)
      place_[lane] = chosen(enabled, lane, places[lane], scratch);
  }
  std::uint8_t* operator[](int lane) const { return place_[lane]; }

 private:
  std::uint8_t* place_[kStripLanes];
};

/// One strip's part of a transfer: `words` words between each enabled PE's place and its column of `row`.
template <class Places>
struct StripTransfer {
  Places place;
  std::uint64_t* row;
  int words;
  unsigned enabled;
};

// Mono memory holds a PE's words side by side, poly memory one word of all PEs of a strip. So a transfer
// transposes, in registers, kBlockWords words of each PE at a time. The last block's `count` is a template
// argument because most records are shorter than two blocks.
#if defined(__AVX512F__)

constexpr int kBlockWords = 8;
// The compilers' own shuffles, because the headers' intrinsics of AVX-512 trip GCC's warning of uninitialised
// values.
using Words __attribute__((vector_size(64))) = long long;
using Block = Words[8];

[[gnu::always_inline]] inline void transpose(Block& block) {
  Block pairs;
#pragma GCC unroll 8
  for (int i = 0; i < 8; i += 2) {
    pairs[i] = __builtin_shufflevector(block[i], block[i + 1], 0, 8, 2, 10, 4, 12, 6, 14);
    pairs[i + 1] = __builtin_shufflevector(block[i], block[i + 1], 1, 9, 3, 11, 5, 13, 7, 15);
  }
  Block fours;
#pragma GCC unroll 8
  for (int i = 0; i < 2; ++i) {
#pragma GCC unroll 8
    for (int half = 0; half < 8; half += 4) {
      fours[half + i] =
          __builtin_shufflevector(pairs[half + i], pairs[half + i + 2], 0, 1, 4, 5, 8, 9, 12, 13);
      fours[half + i + 2] =
          __builtin_shufflevector(pairs[half + i], pairs[half + i + 2], 2, 3, 6, 7, 10, 11, 14, 15);
    }
  }
#pragma GCC unroll 8
  for (int i = 0; i < 4; ++i) {
    block[i] = __builtin_shufflevector(fours[i], fours[i + 4], 0, 1, 4, 5, 8, 9, 12, 13);
    block[i + 4] = __builtin_shufflevector(fours[i], fours[i + 4], 2, 3, 6, 7, 10, 11, 14, 15);
  }
}

template <int count, bool all, class Strip>
[[gnu::always_inline]] inline void load_block(const Strip& strip, int first_word, std::uint64_t* row) {
  constexpr auto kWords = static_cast<__mmask8>((1u << count) - 1);
  Block block;
#pragma GCC unroll 8
  for (int lane = 0; lane < 8; ++lane) {
    const std::uint8_t* const from = strip.place[lane] + 8 * first_word;
    block[lane] = Words(count == 8 ? _mm512_loadu_si512(from) : _mm512_maskz_loadu_epi64(kWords, from));
  }
  transpose(block);
  if constexpr (all) {
#pragma GCC unroll 8
    for (int i = 0; i < count; ++i) _mm512_storeu_si512(row + i * kStripLanes, __m512i(block[i]));
  } else {
    const auto lanes = static_cast<__mmask8>(strip.enabled);
#pragma GCC unroll 8
    for (int i = 0; i < count; ++i) _mm512_mask_storeu_epi64(row + i * kStripLanes, lanes, __m512i(block[i]));
  }
}

template <int count>
[[gnu::always_inline]] inline void store_words(std::uint8_t* to, const Words& words) {
  if constexpr (count == 8) {
    _mm512_storeu_si512(to, __m512i(words));
  } else {
    _mm512_mask_storeu_epi64(to, static_cast<__mmask8>((1u << count) - 1), __m512i(words));
  }
}

template <int count, bool all, class Strip>
[[gnu::always_inline]] inline void save_block(const Strip& strip, int first_word, const std::uint64_t* row) {
  Block block{};
#pragma GCC unroll 8
  for (int i = 0; i < count; ++i) block[i] = Words(_mm512_loadu_si512(row + i * kStripLanes));
  transpose(block);
#pragma GCC unroll 8
  for (int lane = 0; lane < 8; ++lane)
    if (all || ((strip.enabled >> lane) & 1u))
      store_words<count>(strip.place[lane] + 8 * first_word, block[lane]);
}

#elif defined(__AVX2__)

constexpr int kBlockWords = 4;
using Words = __m256i;
using Block = Words[4];

[[gnu::always_inline]] inline void transpose(Block& block) {
  const Words low01 = _mm256_unpacklo_epi64(block[0], block[1]);
  const Words high01 = _mm256_unpackhi_epi64(block[0], block[1]);
  const Words low23 = _mm256_unpacklo_epi64(block[2], block[3]);
  const Words high23 = _mm256_unpackhi_epi64(block[2], block[3]);
  block[0] = _mm256_permute2x128_si256(low01, low23, 0x20);
  block[1] = _mm256_permute2x128_si256(high01, high23, 0x20);
  block[2] = _mm256_permute2x128_si256(low01, low23, 0x31);
  block[3] = _mm256_permute2x128_si256(high01, high23, 0x31);
}

Words* as_vector(void* address) {
  return static_cast<Words*>(address);
}

/// Returns all ones in the lanes whose bits are set.
Words lanes_of_bits(unsigned bits) {
  const Words lane_bit = _mm256_set_epi64x(8, 4, 2, 1);
  return _mm256_cmpeq_epi64(_mm256_and_si256(_mm256_set1_epi64x(bits), lane_bit), lane_bit);
}

template <int count>
[[gnu::always_inline]] inline Words load_words(const std::uint8_t* from) {
  if constexpr (count == 4) return _mm256_loadu_si256(reinterpret_cast<const Words*>(from));
  const Words words = _mm256_set_epi64x(0, count > 2 ? -1 : 0, count > 1 ? -1 : 0, -1);
  return _mm256_maskload_epi64(reinterpret_cast<const long long*>(from), words);
}

template <int count, bool all, class Strip>
[[gnu::always_inline]] inline void load_block(const Strip& strip, int first_word, std::uint64_t* row) {
  for (int half = 0; half < 2; ++half, row += 4) {
    const unsigned enabled = (strip.enabled >> (4 * half)) & 0xfu;
    if (!all && enabled == 0) continue;
    Block block;
#pragma GCC unroll 4
    for (int lane = 0; lane < 4; ++lane)
      block[lane] = load_words<count>(strip.place[4 * half + lane] + 8 * first_word);
    transpose(block);
#pragma GCC unroll 4
    for (int i = 0; i < count; ++i) {
      Words* const to = as_vector(row + i * kStripLanes);
      _mm256_storeu_si256(
          to, all ? block[i] : _mm256_blendv_epi8(_mm256_loadu_si256(to), block[i], lanes_of_bits(enabled)));
    }
  }
}

/// Plain stores, because a masked one takes some 20 cycles on AMD's processors.
template <int count>
[[gnu::always_inline]] inline void store_words(std::uint8_t* to, const Words& words) {
  if constexpr (count == 4) {
    _mm256_storeu_si256(as_vector(to), words);
    return;
  }
  const __m128i low = _mm256_castsi256_si128(words);
  if constexpr (count == 1) _mm_storel_epi64(reinterpret_cast<__m128i*>(to), low);
  if constexpr (count >= 2) _mm_storeu_si128(reinterpret_cast<__m128i*>(to), low);
  if constexpr (count == 3)
    _mm_storel_epi64(reinterpret_cast<__m128i*>(to + 16), _mm256_extracti128_si256(words, 1));
}

template <int count, bool all, class Strip>
[[gnu::always_inline]] inline void save_block(const Strip& strip, int first_word, const std::uint64_t* row) {
  for (int half = 0; half < 2; ++half, row += 4) {
    const unsigned enabled = (strip.enabled >> (4 * half)) & 0xfu;
    Block block{};
#pragma GCC unroll 4
    for (int i = 0; i < count; ++i)
      block[i] = _mm256_loadu_si256(reinterpret_cast<const Words*>(row + i * kStripLanes));
    transpose(block);
#pragma GCC unroll 4
    for (int lane = 0; lane < 4; ++lane)
      if (all || ((enabled >> lane) & 1u))
        store_words<count>(strip.place[4 * half + lane] + 8 * first_word, block[lane]);
  }
}

#else

constexpr int kBlockWords = 1;

template <int, bool, class Strip>
void load_block(const Strip& strip, int word, std::uint64_t* row) {
  for (int lane = 0; lane < kStripLanes; ++lane)
    if ((strip.enabled >> lane) & 1u) std::memcpy(&row[lane], strip.place[lane] + 8 * word, 8);
}
template <int, bool, class Strip>
void save_block(const Strip& strip, int word, const std::uint64_t* row) {
  for (int lane = 0; lane < kStripLanes; ++lane)
    if ((strip.enabled >> lane) & 1u) std::memcpy(strip.place[lane] + 8 * word, &row[lane], 8);
}

#endif

/// @tparam all whether all lanes are enabled, as they mostly are
template <Direction direction, int count, bool all, class Strip>
[[gnu::always_inline]] inline void move_block(const Strip& strip, int first_word) {
  std::uint64_t* const row = strip.row + std::size_t(first_word) * kStripLanes;
  if constexpr (direction == Direction::mono_to_poly) {
    load_block<count, all>(strip, first_word, row);
  } else {
    save_block<count, all>(strip, first_word, row);
  }
}

/// @tparam tail number of words behind the last whole block
template <Direction direction, int tail, bool all, class Strip>
[[gnu::always_inline]] inline void move_strip(const Strip& strip) {
  const int in_blocks = strip.words - tail;
  for (int w = 0; w < in_blocks; w += kBlockWords) move_block<direction, kBlockWords, all>(strip, w);
  if constexpr (tail > 0) move_block<direction, tail, all>(strip, in_blocks);
}

/// Whether the enabled lanes' pieces follow each other without overlapping; their words may then be stored in
/// any order.
template <class Strip>
bool is_ascending(const Strip& strip) {
  const std::uint8_t* end = nullptr;
  bool ascending = true;
  for (int lane = 0; lane < kStripLanes; ++lane) {
    const std::uint8_t* const place = chosen<const std::uint8_t>(strip.enabled, lane, strip.place[lane], end);
    ascending &= end <= place;
    end = chosen<const std::uint8_t>(strip.enabled, lane, place + 8 * strip.words, end);
  }
  return ascending;
}

/// PEs are served in ascending order: of two that save to the same word, the higher one's is kept.
template <class Strip>
void save_in_pe_order(const Strip& strip) {
  for (int lane = 0; lane < kStripLanes; ++lane)
    if ((strip.enabled >> lane) & 1u)
      for (int w = 0; w < strip.words; ++w)
        std::memcpy(strip.place[lane] + 8 * w, &strip.row[std::size_t(w) * kStripLanes + std::size_t(lane)],
                    8);
}

/// Prefetches what the next strip loads while this one's data are moved, because records of rays are
/// scattered over mono memory.
[[gnu::always_inline]] inline void prefetch_strip(const Transfer& transfer, int first_pe,
                                                  std::uint8_t* mono) {
  constexpr int kLineBytes = 64;
  const unsigned enabled = transfer.enabled.strip_bits(first_pe / kStripLanes);
  if (enabled == 0) return;
  const PlacesOfEach places(transfer.mono, first_pe, enabled, mono);
  const int last = transfer.poly.size_bytes - 1;
  for (int lane = 0; lane < kStripLanes; ++lane) {
    for (int line = 0; line < last; line += kLineBytes) __builtin_prefetch(places[lane] + line);
    __builtin_prefetch(places[lane] + last);
  }
}

/// Size of the scratch place. Larger records are saved lane by lane.
constexpr int kScratchBytes = 512;

template <Direction direction, int tail, class Places>
void move_strips(const Transfer& transfer, PolyMemory& poly, std::uint8_t* mono) {
  constexpr bool loads = direction == Direction::mono_to_poly;
  const bool may_overlap =
      !loads && (Places::kAnywhere || transfer.mono.stride_bytes < std::uint64_t(transfer.poly.size_bytes));
  const int num_pes = poly.num_pes();
  for (int first_pe = 0; first_pe < num_pes; first_pe += kStripLanes) {
    const unsigned enabled = transfer.enabled.strip_bits(first_pe / kStripLanes);
    if (enabled == 0) continue;
    if (loads && Places::kAnywhere && first_pe + kStripLanes < num_pes)
      prefetch_strip(transfer, first_pe + kStripLanes, mono);
    const StripTransfer<Places> strip{Places(transfer.mono, first_pe, enabled, mono),
                                      poly.strip(first_pe, transfer.poly.offset_bytes),
                                      transfer.poly.size_bytes / 8, enabled};
    if (may_overlap && !is_ascending(strip)) {
      save_in_pe_order(strip);
    } else if (enabled == kAllLanes) {
      move_strip<direction, tail, true>(strip);
    } else if (!loads && transfer.poly.size_bytes <= kScratchBytes) {
      std::uint8_t scratch[kScratchBytes];
      move_strip<direction, tail, true>(
          StripTransfer<PlacesOrScratch>{{strip.place, enabled, scratch}, strip.row, strip.words, enabled});
    } else {
      move_strip<direction, tail, false>(strip);
    }
  }
}

template <Direction direction, int tail = 0>
void move_with_tail(const Transfer& transfer, PolyMemory& poly, std::uint8_t* mono) {
  if (transfer.poly.size_bytes / 8 % kBlockWords == tail) {
    if (transfer.mono.by_pe == nullptr) {
      move_strips<direction, tail, PlacesInArray>(transfer, poly, mono);
    } else {
      move_strips<direction, tail, PlacesOfEach>(transfer, poly, mono);
    }
  } else if constexpr (tail + 1 < kBlockWords) {
    move_with_tail<direction, tail + 1>(transfer, poly, mono);
  }
}

}  // namespace

namespace CN_LEVEL {

void move_data(const Transfer& transfer, PolyMemory& poly, std::uint8_t* mono) {
  if (transfer.direction == Direction::mono_to_poly) {
    move_with_tail<Direction::mono_to_poly>(transfer, poly, mono);
  } else {
    move_with_tail<Direction::poly_to_mono>(transfer, poly, mono);
  }
}

}  // namespace CN_LEVEL

}  // namespace cn
