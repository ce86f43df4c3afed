#pragma once

#include <cstdint>

#include "firmware/cn/language/poly.hpp"

namespace path_tracer {

/// The use of a group of four random numbers. It is part of the counter, so that uses never share numbers.
enum class Purpose : std::uint32_t {
  camera,
  scatter,
  light,
  lobe,
  coverage,
  // Of light paths, which have numbers of their own (bidirectional/):
  light_start,  ///< the light, and the point on it
  emission,     ///< the direction that the path begins with
  light_scatter,
  light_lobe,
  light_coverage,         ///< of a light path's segments
  lens_coverage,          ///< of connections: of the light path's vertices to the lens
  light_sample_coverage,  ///< of the eye path's to points of lights
  light_vertex_coverage,  ///< and to vertices of the light path
};

/// A purpose for each of many things: the counter's word for it. @param number from 0, below 2^28
inline cn::poly<std::uint32_t> purpose_for_each(const cn::poly<std::uint32_t>& purpose,
                                                const cn::poly<std::int32_t>& number) {
  constexpr int kPurposeBits = 4;
  return (cn::reinterpret_word<std::uint32_t>(number) << kPurposeBits) | purpose;
}

/// Four uniform numbers in (0, 1).
struct Uniform4 {
  cn::poly<double> value[4];
};

/// Four 32-bit words.
struct Words4 {
  cn::poly<std::uint32_t> word[4];
};

inline constexpr int kPhiloxRounds = 10;

/// Philox4x32 (Salmon, Moraes, Dror, Shaw, SC 2011): encrypts `counter` with a key.
template <int rounds>
inline Words4 philox(std::uint64_t key, const Words4& counter) {
  using Word = cn::poly<std::uint32_t>;
  constexpr std::uint32_t kMultiplier0 = 0xD2511F53u;
  constexpr std::uint32_t kMultiplier1 = 0xCD9E8D57u;
  constexpr std::uint32_t kWeyl0 = 0x9E3779B9u;
  constexpr std::uint32_t kWeyl1 = 0xBB67AE85u;

  Word word0 = counter.word[0];
  Word word1 = counter.word[1];
  Word word2 = counter.word[2];
  Word word3 = counter.word[3];
  auto key0 = static_cast<std::uint32_t>(key);
  auto key1 = static_cast<std::uint32_t>(key >> 32);
  for (int round = 0; round < rounds; ++round) {
    const cn::WideProduct product0 = cn::multiply_wide(word0, kMultiplier0);
    const cn::WideProduct product1 = cn::multiply_wide(word2, kMultiplier1);
    const Word next0 = product1.high ^ word1 ^ Word(key0);
    const Word next2 = product0.high ^ word3 ^ Word(key1);
    word0.assign_all_lanes(next0);
    word1.assign_all_lanes(product1.low);
    word2.assign_all_lanes(next2);
    word3.assign_all_lanes(product0.low);
    key0 += kWeyl0;
    key1 += kWeyl1;
  }
  return {{word0, word1, word2, word3}};
}

/// Returns the middle of one of 2^32 equal steps: never 0, never 1.
inline cn::poly<double> uniform_of(const cn::poly<std::uint32_t>& word) {
  constexpr double kStep = 1.0 / 4294967296.0;
  return (cn::convert<double>(word) + 0.5) * kStep;
}

/// Random numbers as a function of their use: the same pixel, sample, depth and purpose give the same numbers
/// wherever and whenever a path is traced.
/// @param purpose a Purpose, or one of purpose_for_each()
inline Uniform4 uniform4(std::uint64_t seed, const cn::poly<std::int32_t>& pixel,
                         const cn::poly<std::int32_t>& sample, const cn::poly<std::int32_t>& depth,
                         const cn::poly<std::uint32_t>& purpose) {
  const Words4 words = philox<kPhiloxRounds>(
      seed, {{cn::reinterpret_word<std::uint32_t>(pixel), cn::reinterpret_word<std::uint32_t>(sample),
              cn::reinterpret_word<std::uint32_t>(depth), purpose}});
  return {{uniform_of(words.word[0]), uniform_of(words.word[1]), uniform_of(words.word[2]),
           uniform_of(words.word[3])}};
}
inline Uniform4 uniform4(std::uint64_t seed, const cn::poly<std::int32_t>& pixel,
                         const cn::poly<std::int32_t>& sample, const cn::poly<std::int32_t>& depth,
                         Purpose purpose) {
  return uniform4(seed, pixel, sample, depth, static_cast<std::uint32_t>(purpose));
}

}  // namespace path_tracer
