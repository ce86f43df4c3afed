#pragma once

#include "firmware/cn/language/math.hpp"
#include "firmware/examples/kernels.hpp"

namespace examples {

using Word = cn::poly<std::uint32_t>;

/// taus88, L'Ecuyer, "Maximally equidistributed combined Tausworthe generators", 1996: shifts and logic only,
/// for PEs whose integer unit multiplies slowly. 20 operations on 32 bits.
class Taus88 {
 public:
  explicit Taus88(const PolyField<std::uint32_t> (&state)[3])
      : word_{state[0].read(), state[1].read(), state[2].read()} {}

  Word next() {
    word_[0].assign_all_lanes(((word_[0] & 0xfffffffeu) << 12) ^ (((word_[0] << 13) ^ word_[0]) >> 19));
    word_[1].assign_all_lanes(((word_[1] & 0xfffffff8u) << 4) ^ (((word_[1] << 2) ^ word_[1]) >> 25));
    word_[2].assign_all_lanes(((word_[2] & 0xfffffff0u) << 17) ^ (((word_[2] << 3) ^ word_[2]) >> 11));
    return word_[0] ^ word_[1] ^ word_[2];
  }

  /// Returns a number in (0, 1): the middle of one of 2^32 equal steps.
  cn::poly<double> next_uniform() {
    constexpr double kStep = 1.0 / 4294967296.0;
    return (cn::convert<double>(next()) + 0.5) * kStep;
  }

  void save(const PolyField<std::uint32_t> (&state)[3]) const {
    for (int i = 0; i < 3; ++i) state[i].write(word_[i]);
  }

 private:
  Word word_[3];
};

/// Finaliser of MurmurHash3 (Appleby): neighbouring inputs give unrelated numbers.
inline Word scramble(Word word) {
  word.assign_all_lanes((word ^ (word >> 16)) * 0x85ebca6bu);
  word.assign_all_lanes((word ^ (word >> 13)) * 0xc2b2ae35u);
  return word ^ (word >> 16);
}

/// Gives each PE its own stream.
inline void seed_random(const SeedRandomArguments& arguments) {
  const Word pe = cn::reinterpret_word<std::uint32_t>(cn::pe_num());
  constexpr std::uint32_t kAboveTheLeast = 0x80;  // states below 2, 8 and 16 never leave zero
  for (std::uint32_t i = 0; i < 3; ++i)
    arguments.word[i].write(scramble(scramble(arguments.seed) + pe + (i << 10)) | kAboveTheLeast);
}

struct NormalPair {
  cn::poly<double> first;
  cn::poly<double> second;
};

/// Box and Muller, 1958. The polar method would need fewer instructions if each PE could branch on its own;
/// in lock step, all PEs wait for the one with the most rejections.
inline NormalPair next_normals(Taus88& random) {
  constexpr double kTwoPi = 6.283185307179586477;
  const cn::poly<double> radius = cn::sqrt(cn::log(random.next_uniform()) * -2.0);
  const cn::SineCosine angle = cn::sincos(random.next_uniform() * kTwoPi);
  return {radius * angle.cosine, radius * angle.sine};
}

inline cn::poly<double> payoff(const SamplePayoffsArguments& option, const cn::poly<double>& normal) {
  const cn::poly<double> price = cn::exp(normal * option.diffusion + option.drift) * option.spot;
  return cn::max(price - option.strike, cn::poly<double>(0.0));
}

inline void sample_payoffs(const SamplePayoffsArguments& arguments) {
  Taus88 random(arguments.word);
  cn::poly<double> sum = arguments.sum.read();
  for (int pair = 0; pair < arguments.pairs; ++pair) {
    const NormalPair normal = next_normals(random);
    sum.assign_all_lanes(sum + payoff(arguments, normal.first));
    sum.assign_all_lanes(sum + payoff(arguments, normal.second));
  }
  arguments.sum.write(sum);
  random.save(arguments.word);
}

}  // namespace examples
