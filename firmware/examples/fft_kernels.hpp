#pragma once

#include "firmware/cn/language/float_bits.hpp"
#include "firmware/examples/fft.hpp"

namespace examples {

using Words = cn::poly4<std::uint64_t>;

/// Four complex numbers for each PE; their real and imaginary parts take 32 of the 128 bytes of registers.
struct Complex4 {
  cn::poly4<float> real;
  cn::poly4<float> imaginary;
};

/// Names the same registers differently: the words of a complex number are its parts.
inline Complex4 to_complex(const Words& words) {
  return {
      {cn::low_float(words[0]), cn::low_float(words[1]), cn::low_float(words[2]), cn::low_float(words[3])},
      {cn::high_float(words[0]), cn::high_float(words[1]), cn::high_float(words[2]),
       cn::high_float(words[3])}};
}

inline Words to_words(const Complex4& a) {
  const auto word = [&](int i) { return cn::join_floats(a.real[i], a.imaginary[i]); };
  return {word(0), word(1), word(2), word(3)};
}

inline Complex4 operator+(const Complex4& a, const Complex4& b) {
  return {a.real + b.real, a.imaginary + b.imaginary};
}
inline Complex4 operator-(const Complex4& a, const Complex4& b) {
  return {a.real - b.real, a.imaginary - b.imaginary};
}

/// A mono factor for each of the four complex numbers, for a vector instruction.
struct Factor4 {
  cn::mono4<float> real;
  cn::mono4<float> imaginary;
};

inline Factor4 factors(const Complex* twiddles, const cn::Indices4& at) {
  Factor4 factor;
  for (std::size_t i = 0; i < 4; ++i) {
    factor.real[i] = twiddles[at[i]].real;
    factor.imaginary[i] = twiddles[at[i]].imaginary;
  }
  return factor;
}

inline Complex4 operator*(const Complex4& a, const Factor4& factor) {
  return {multiply_subtract(a.real, factor.real, a.imaginary * factor.imaginary),
          multiply_add(a.real, factor.imaginary, a.imaginary * factor.real)};
}

/// Computes a + b factor and from it a - b factor = 2 a - (a + b factor): a butterfly of six multiply-adds
/// (Linzer and Feig, 1993).
inline Complex4 add_product(const Complex4& a, const Complex4& b, const Factor4& factor) {
  const Factor4 minus = {
      factor.real, {-factor.imaginary[0], -factor.imaginary[1], -factor.imaginary[2], -factor.imaginary[3]}};
  return {multiply_add(b.imaginary, minus.imaginary, multiply_add(b.real, factor.real, a.real)),
          multiply_add(b.imaginary, factor.real, multiply_add(b.real, factor.imaginary, a.imaginary))};
}
inline Complex4 twice_minus(const Complex4& a, const Complex4& sum) {
  return {multiply_subtract(a.real, 2.0f, sum.real), multiply_subtract(a.imaginary, 2.0f, sum.imaginary)};
}

/// Two stages of butterflies on four complex numbers, at first + x * first_span + y * second_span: first
/// between the two x, then between the two y.
struct Quad {
  int first;
  int first_span;
  int second_span;

  int at(int x, int y) const { return first + x * first_span + y * second_span; }
};

/// Returns quad `number` of 64 in stages `stage` and `stage` + 1. Spans grow if numbers come in bit-reversed
/// order, and shrink if they come in natural order.
inline Quad quad(const FftArguments& arguments, int stage, int number) {
  const int small = 1 << (arguments.from_reversed ? stage : kIndexBits - 2 - stage);
  const int within = number % small;
  const int first = 4 * (number - within) + within;
  return arguments.from_reversed ? Quad{first, small, 2 * small} : Quad{first, 2 * small, small};
}

/// Returns the twiddle of a butterfly of the numbers `upper` and `upper` + span (Cooley and Tukey, 1965): by
/// its place within its block, or by its block's bit-reversed number.
inline int twiddle_of(const FftArguments& arguments, int span, int upper) {
  if (arguments.from_reversed) return upper % span * (kComplexPerPe / span);
  int reversed = 0;
  for (int block = upper / (2 * span), bit = kComplexPerPe / 2; block != 0; block >>= 1, bit >>= 1)
    reversed += block % 2 * bit;
  return reversed;
}

struct Butterflies4 {
  Complex4 sum;
  Complex4 difference;
};

inline Butterflies4 butterflies(const FftArguments& arguments, const Complex4& a, const Complex4& b,
                                const cn::Indices4& twiddles) {
  if (twiddles == cn::Indices4{}) return {a + b, a - b};
  const Complex4 sum = add_product(a, b, factors(arguments.twiddles, twiddles));
  return {sum, twice_minus(a, sum)};
}

/// Returns the numbers at even (0) or odd (1) places of the sums, then of the differences: every second
/// complex number of 64 bytes of registers.
inline Complex4 every_second(const Butterflies4& from, int first) {
  const Complex4& a = from.sum;
  const Complex4& b = from.difference;
  return {{a.real[first], a.real[first + 2], b.real[first], b.real[first + 2]},
          {a.imaginary[first], a.imaginary[first + 2], b.imaginary[first], b.imaginary[first + 2]}};
}

/// Two stages of two quads: eight complex numbers take 64 of the 128 bytes of registers, and their results as
/// much.
inline void two_stages(const FftArguments& arguments, const Quad& one, const Quad& two) {
  const auto places = [&](int x0, int y0, int x1, int y1) {
    return cn::Indices4{one.at(x0, y0), one.at(x1, y1), two.at(x0, y0), two.at(x1, y1)};
  };
  const auto twiddles = [&](int span, const cn::Indices4& upper) {
    cn::Indices4 at;
    for (std::size_t i = 0; i < 4; ++i) at[i] = twiddle_of(arguments, span, upper[i]);
    return at;
  };
  const cn::Indices4 x0 = places(0, 0, 0, 1);
  const cn::Indices4 x1 = places(1, 0, 1, 1);
  const Butterflies4 first = butterflies(arguments, to_complex(arguments.data.load(x0)),
                                         to_complex(arguments.data.load(x1)), twiddles(one.first_span, x0));
  const cn::Indices4 y0{one.at(0, 0), two.at(0, 0), one.at(1, 0), two.at(1, 0)};
  const cn::Indices4 y1{one.at(0, 1), two.at(0, 1), one.at(1, 1), two.at(1, 1)};
  const Butterflies4 second =
      butterflies(arguments, every_second(first, 0), every_second(first, 1), twiddles(one.second_span, y0));
  arguments.data.store(y0, to_words(second.sum));
  arguments.data.store(y1, to_words(second.difference));
}

/// Transforms the 256 numbers within each PE, from bit-reversed order to natural or back. Stages come in
/// pairs, so each number is loaded and stored four times instead of eight.
inline void fft_local(const FftArguments& arguments) {
  for (int stage = 0; stage < kIndexBits; stage += 2)
    for (int number = 0; number < kComplexPerPe / 4; number += 2)
      two_stages(arguments, quad(arguments, stage, number), quad(arguments, stage, number + 1));
}

/// Returns true in the PEs whose number has that bit.
inline cn::mask has_pe_bit(int bit) {
  return (cn::pe_num() & cn::poly<std::int32_t>(1 << bit)) != cn::poly<std::int32_t>(0);
}

/// First half of the butterflies between the two PEs of a line: multiplies the odd PE's numbers by exp(-2 pi
/// i k / 512).
inline void fft_twiddle(const FftArguments& arguments) {
  cn::poly_if(has_pe_bit(0), [&] {
    for (int index = 0; index < kComplexPerPe; index += 4) {
      const cn::Indices4 at = cn::four_from(index);
      const Complex4 turned = to_complex(arguments.data.load(at)) * factors(arguments.twiddles, at);
      arguments.data.store(at, to_words(turned));
    }
  });
}

/// Second half of the butterflies between the two PEs of a line: the even PE gets the sums, the odd PE the
/// differences.
inline void fft_pair(const FftArguments& arguments) {
  const cn::mask odd = has_pe_bit(0);
  const cn::poly<float> sign = cn::select(odd, cn::poly<float>(-1), cn::poly<float>(1));
  const cn::poly4<float> signs(sign, sign, sign, sign);
  for (int index = 0; index < kScratchComplex; index += 4) {
    const cn::Indices4 at = cn::four_from(arguments.half * kScratchComplex + index);
    const Complex4 own = to_complex(arguments.data.load(at));
    const Complex4 other = to_complex(
        select(odd, arguments.data.load_and_swazzle(at, 1), arguments.data.load_and_swazzle(at, -1)));
    arguments.scratch.store(cn::four_from(index),
                            to_words({multiply_add(own.real, signs, other.real),
                                      multiply_add(own.imaginary, signs, other.imaginary)}));
  }
}

inline void fft_pair_store(const FftArguments& arguments) {
  for (int index = 0; index < kScratchComplex; index += 4)
    arguments.data.store(cn::four_from(arguments.half * kScratchComplex + index),
                         arguments.scratch.load(cn::four_from(index)));
}

/// Returns the index-th and the following three places whose index has the bit clear, or the same with the
/// bit set.
struct ExchangePlaces {
  cn::Indices4 clear;
  cn::Indices4 set;
};

inline ExchangePlaces exchange_places(int first, int bit) {
  ExchangePlaces places;
  for (int i = 0; i < 4; ++i) {
    const int low = (first + i) & ((1 << bit) - 1);
    places.clear[std::size_t(i)] = 2 * (first + i) - low;
    places.set[std::size_t(i)] = places.clear[std::size_t(i)] + (1 << bit);
  }
  return places;
}

/// Swaps a bit of the PE's number with a bit of the index: PEs with the bit clear give the half of their data
/// with the index bit set, and get their partners' half with it clear.
inline void fft_exchange(const FftArguments& arguments) {
  const cn::mask has_bit = has_pe_bit(arguments.pe_bit);
  const int steps = 1 << arguments.pe_bit;
  for (int i = 0; i < kScratchComplex; i += 4) {
    const ExchangePlaces at = exchange_places(i, arguments.index_bit);
    arguments.scratch.store(cn::four_from(i), select(has_bit, arguments.data.load_and_swazzle(at.set, steps),
                                                     arguments.data.load_and_swazzle(at.clear, -steps)));
  }
}

inline void fft_exchange_store(const FftArguments& arguments) {
  const cn::mask has_bit = has_pe_bit(arguments.pe_bit);
  for (int i = 0; i < kScratchComplex; i += 4) {
    const ExchangePlaces at = exchange_places(i, arguments.index_bit);
    const Words received = arguments.scratch.load(cn::four_from(i));
    cn::poly_if(
        has_bit, [&] { arguments.data.store(at.clear, received); },
        [&] { arguments.data.store(at.set, received); });
  }
}

inline void fft_places(const FftPlacesArguments& arguments) {
  using Number = cn::poly<std::int32_t>;
  const Number pe = cn::pe_num();
  const auto bits = [&](int first, int count) { return (pe >> first) & Number((1 << count) - 1); };
  const auto address = [](const Number& bytes) { return cn::convert<cn::MonoAddress>(bytes); };
  const Number group = pe >> kGroupBits;
  const Number in_group = bits(0, kGroupBits);
  // fft.cpp tells which columns the exchange leaves in a PE.
  const Number column_set = bits(2, 3) + (bits(1, 1) << 3) + (bits(0, 1) << 4);
  arguments.tile_save.write(address(group * kTileRowBytes + column_set * kPieceBytes));
  arguments.tile_load.write(address(in_group * kTileRowBytes + group * kPieceBytes));
  arguments.result.write(address(group * (2 * kLineBytes) + bits(1, 1) * kLineBytes +
                                 bits(2, 3) * (64 * kLineBytes) + bits(0, 1) * kPieceBytes));
}

}  // namespace examples
