#pragma once

#include "firmware/cn/language/bits.hpp"
#include "firmware/path_tracer/sampling/random.hpp"

/// Owen-scrambled Sobol points, padded: each use of a pair of numbers has its own two-dimensional sequence,
/// scrambled and shuffled by hashing (Burley, "Practical Hash-based Owen Scrambling", JCGT 9(4), 2020), so
/// any point of any sequence is a function of its counter. Points of a pixel fill the square evenly; each
/// one is uniform, so estimates stay unbiased.
namespace path_tracer {

using Word = cn::poly<std::uint32_t>;

/// Rounds of Philox for scrambling words: the fewest that pass all tests of randomness (Salmon et al., SC
/// 2011).
inline constexpr int kScramblingRounds = 7;

/// Owen's nested scrambling of a number with reversed bits: each bit is flipped depending on the bits below
/// it (Laine and Karras, EGSR 2011; constants of Burley 2020, section 2).
inline Word scramble_reversed(const Word& reversed, const Word& seed) {
  Word x = reversed + seed;
  for (const std::uint32_t even : {0x6c50b47cu, 0xb82f1e52u, 0xc7afe638u, 0x8d22f6e6u}) {
    const Word next = x ^ cn::multiply_wide(x, even).low;
    x.assign_all_lanes(next);
  }
  return x;
}

/// Returns Sobol's second coordinate of a point number, with reversed bits. The generator matrix is Pascal's
/// triangle modulo 2: bit j is the sum of the bits whose places contain j (Lucas), and such sums over
/// supersets take one step for each bit of a place.
inline Word sobol_second_reversed(const Word& number) {
  Word x = number;
  const auto add_supersets = [&x](std::uint32_t places, int distance) {
    const Word next = x ^ ((x & Word(places)) >> distance);
    x.assign_all_lanes(next);
  };
  add_supersets(0xaaaaaaaau, 1);
  add_supersets(0xccccccccu, 2);
  add_supersets(0xf0f0f0f0u, 4);
  add_supersets(0xff00ff00u, 8);
  add_supersets(0xffff0000u, 16);
  return x;
}

/// The state that one point of one pixel's sequences is made from.
struct SobolPoint {
  Word reversed_sample;  ///< the sample's number with reversed bits
  Words4 scramblings;
};

/// @param purpose a Purpose, or one of purpose_for_each()
inline SobolPoint sobol_point(std::uint64_t seed, const cn::poly<std::int32_t>& pixel,
                              const cn::poly<std::int32_t>& sample, const cn::poly<std::int32_t>& depth,
                              const Word& purpose) {
  const Words4 scramblings =
      philox<kScramblingRounds>(seed, {{cn::reinterpret_word<std::uint32_t>(pixel), std::uint32_t{0},
                                        cn::reinterpret_word<std::uint32_t>(depth), purpose}});
  return {cn::reverse_bits(cn::reinterpret_word<std::uint32_t>(sample)), scramblings};
}
inline SobolPoint sobol_point(std::uint64_t seed, const cn::poly<std::int32_t>& pixel,
                              const cn::poly<std::int32_t>& sample, const cn::poly<std::int32_t>& depth,
                              Purpose purpose) {
  return sobol_point(seed, pixel, sample, depth, Word(static_cast<std::uint32_t>(purpose)));
}

struct UniformPair {
  cn::poly<double> u;
  cn::poly<double> v;
};

/// Returns two numbers in (0, 1) that are stratified together over the samples of a pixel.
inline UniformPair sobol_pair(const SobolPoint& point) {
  const Word* const scrambling = point.scramblings.word;
  const Word number = cn::reverse_bits(scramble_reversed(point.reversed_sample, scrambling[0]));
  const Word u = cn::reverse_bits(scramble_reversed(number, scrambling[1]));
  const Word v = cn::reverse_bits(scramble_reversed(sobol_second_reversed(number), scrambling[2]));
  return {uniform_of(u), uniform_of(v)};
}

/// Returns a number in (0, 1) that is stratified over the samples of a pixel, independent of the pair.
/// Scrambling looks at a word's low bits first, so one word serves for order and value.
inline cn::poly<double> sobol_single(const SobolPoint& point) {
  const Word& scrambling = point.scramblings.word[3];
  const Word number = cn::reverse_bits(scramble_reversed(point.reversed_sample, scrambling));
  return uniform_of(cn::reverse_bits(scramble_reversed(number, scrambling >> 16)));
}

}  // namespace path_tracer
