#pragma once

#include "firmware/cn/float_bits.hpp"
#include "firmware/examples/fft.hpp"

namespace examples {

using Words = cn::poly4<std::uint64_t>;

/// Four complex numbers a PE; with their four real and imaginary parts 32 of the 128 bytes of registers.
struct Complex4 {
  cn::poly4<float> real;
  cn::poly4<float> imaginary;
};

/// The same registers under other names: the words of a complex number are its parts.
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

/// A mono factor for each of the four complex numbers, as the vector unit takes it.
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

/// a + b factor and, with that, a - b factor = 2 a - (a + b factor): a butterfly of six multiply-adds (Linzer
/// and Feig, 1993).
inline Complex4 add_product(const Complex4& a, const Complex4& b, const Factor4& factor) {
  const Factor4 minus = {
      factor.real, {-factor.imaginary[0], -factor.imaginary[1], -factor.imaginary[2], -factor.imaginary[3]}};
  return {multiply_add(b.imaginary, minus.imaginary, multiply_add(b.real, factor.real, a.real)),
          multiply_add(b.imaginary, factor.real, multiply_add(b.real, factor.imaginary, a.imaginary))};
}
inline Complex4 twice_minus(const Complex4& a, const Complex4& sum) {
  return {multiply_subtract(a.real, 2.0f, sum.real), multiply_subtract(a.imaginary, 2.0f, sum.imaginary)};
}

/// The 256 numbers of each PE, by itself. Decimation in frequency takes them in natural order and leaves them
/// in bit-reversed order; decimation in time the other way round.
inline void fft_local(const FftArguments& arguments) {
  for (int stage = 0; stage < kIndexBits; ++stage) {
    const int span = 1 << (arguments.decimate_in_time ? stage : kIndexBits - 1 - stage);
    for (int butterfly = 0; butterfly < kComplexPerPe / 2; butterfly += 4) {
      cn::Indices4 upper;
      cn::Indices4 lower;
      cn::Indices4 twiddle_at;
      for (int i = 0; i < 4; ++i) {
        const int within = (butterfly + i) % span;
        upper[std::size_t(i)] = 2 * (butterfly + i) - within;
        lower[std::size_t(i)] = upper[std::size_t(i)] + span;
        twiddle_at[std::size_t(i)] = within * (kComplexPerPe / span);
      }
      const Factor4 twiddle = factors(arguments.twiddles, twiddle_at);
      const Complex4 a = to_complex(arguments.data.load(upper));
      const Complex4 b = to_complex(arguments.data.load(lower));
      if (span == 1) {  // all factors are 1
        arguments.data.store(upper, to_words(a + b));
        arguments.data.store(lower, to_words(a - b));
      } else if (arguments.decimate_in_time) {
        const Complex4 sum = add_product(a, b, twiddle);
        arguments.data.store(upper, to_words(sum));
        arguments.data.store(lower, to_words(twice_minus(a, sum)));
      } else {
        arguments.data.store(upper, to_words(a + b));
        arguments.data.store(lower, to_words((a - b) * twiddle));
      }
    }
  }
}

/// True in the PEs whose number has that bit.
inline cn::mask has_pe_bit(int bit) {
  return (cn::pe_num() & cn::poly<std::int32_t>(1 << bit)) != cn::poly<std::int32_t>(0);
}

/// Between the two PEs of a line: the odd one's numbers times exp(-2 pi i k / 512).
inline void fft_twiddle(const FftArguments& arguments) {
  cn::poly_if(has_pe_bit(0), [&] {
    for (int index = 0; index < kComplexPerPe; index += 4) {
      const cn::Indices4 at = cn::four_from(index);
      const Complex4 turned = to_complex(arguments.data.load(at)) * factors(arguments.twiddles, at);
      arguments.data.store(at, to_words(turned));
    }
  });
}

/// Between the two PEs of a line: the even one gets the sums, the odd one the differences.
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

/// The index-th and the following three places whose index has the bit clear, and the same with it set.
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

/// Swaps a bit of the PE's number with a bit of the index: PEs with the bit clear give away their half of the
/// data with the index bit set for their partners' half with it clear.
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
  // Which columns the exchange leaves in a PE: fft.cpp.
  const Number column_set = bits(2, 3) + (bits(1, 1) << 3) + (bits(0, 1) << 4);
  arguments.tile_save.write(address(group * kTileRowBytes + column_set * kPieceBytes));
  arguments.tile_load.write(address(in_group * kTileRowBytes + group * kPieceBytes));
  arguments.result.write(address(group * (2 * kLineBytes) + bits(1, 1) * kLineBytes +
                                 bits(2, 3) * (64 * kLineBytes) + bits(0, 1) * kPieceBytes));
}

}  // namespace examples
