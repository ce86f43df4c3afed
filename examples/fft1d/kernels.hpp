#pragma once

#include "firmware/cn/language/float_bits.hpp"
#include "firmware/cn/language/poly4.hpp"
#include "firmware/cn/machine.hpp"

/// Kernels of a transform of 1,024 complex numbers in single precision, spread over 8 PEs with 128 each.
namespace fft1d {

inline constexpr int kSize = 1024;
inline constexpr int kGroupBits = 3;
inline constexpr int kGroup = 1 << kGroupBits;  ///< PEs of a transform
inline constexpr int kOfPe = kSize / kGroup;    ///< complex numbers of a PE
inline constexpr int kRun = kOfPe / kGroup;     ///< neighbours that a PE loads in a piece

struct Complex {
  float real = 0;
  float imaginary = 0;
};

using Words = cn::poly4<std::uint64_t>;

struct Complex4 {
  cn::poly4<float> real;
  cn::poly4<float> imaginary;
};

inline Complex4 to_complex(const Words& w) {
  return {{cn::low_float(w[0]), cn::low_float(w[1]), cn::low_float(w[2]), cn::low_float(w[3])},
          {cn::high_float(w[0]), cn::high_float(w[1]), cn::high_float(w[2]), cn::high_float(w[3])}};
}
inline Words to_words(const Complex4& a) {
  const auto word = [&](int i) { return cn::join_floats(a.real[i], a.imaginary[i]); };
  return {word(0), word(1), word(2), word(3)};
}

struct StageArguments {
  cn::PolyArray<std::uint64_t> data;
  const Complex* twiddles;  ///< mono: exp(-2 pi i k / 256), k = 0..127
  int last_span;            ///< of the spans 64, 32, ..., 1 of butterflies
};

/// Butterflies between `upper` and `upper` + span for numbers in natural order: the twiddle belongs to the
/// block of 2 span numbers, by its bit-reversed number (Cooley and Tukey, 1965).
inline int twiddle_of(int span, int upper) {
  int reversed = 0;
  for (int block = upper / (2 * span), bit = kOfPe / 2; block != 0; block >>= 1, bit >>= 1)
    reversed += block % 2 * bit;
  return reversed;
}

struct Butterflies4 {
  Complex4 sum;
  Complex4 difference;
};

/// a + b w, and a - b w = 2 a - (a + b w): six multiply-adds (Linzer and Feig, 1993).
inline Butterflies4 butterflies(const StageArguments& arguments, int span, const cn::Indices4& upper,
                                const Complex4& a, const Complex4& b) {
  cn::mono4<float> real, imaginary, minus;
  bool all_one = true;
  for (std::size_t i = 0; i < 4; ++i) {
    const int k = twiddle_of(span, upper[i]);
    const Complex w = arguments.twiddles[k];
    real[i] = w.real, imaginary[i] = w.imaginary, minus[i] = -w.imaginary;
    all_one = all_one && k == 0;
  }
  if (all_one)
    return {{a.real + b.real, a.imaginary + b.imaginary}, {a.real - b.real, a.imaginary - b.imaginary}};
  const Complex4 sum = {multiply_add(b.imaginary, minus, multiply_add(b.real, real, a.real)),
                        multiply_add(b.imaginary, real, multiply_add(b.real, imaginary, a.imaginary))};
  return {sum,
          {multiply_subtract(a.real, 2.0f, sum.real), multiply_subtract(a.imaginary, 2.0f, sum.imaginary)}};
}

/// Elements `first` and `first` + 2 of the sums, then of the differences.
inline Complex4 every_second(const Butterflies4& from, int first) {
  const auto of = [&](const cn::poly4<float>& s, const cn::poly4<float>& d) {
    return cn::poly4<float>{s[first], s[first + 2], d[first], d[first + 2]};
  };
  return {of(from.sum.real, from.difference.real), of(from.sum.imaginary, from.difference.imaginary)};
}

/// The stages of spans `span` and `span` / 2 without a store in between: eight numbers in registers.
inline void two_stages(const StageArguments& arguments, int span, int first) {
  const int half = span / 2;
  const auto at = [&](int a, int b) {
    return cn::Indices4{first + a, first + b, first + a + 1, first + b + 1};
  };
  const auto load = [&](const cn::Indices4& from) { return to_complex(arguments.data.load(from)); };
  const Butterflies4 wide =
      butterflies(arguments, span, at(0, half), load(at(0, half)), load(at(span, span + half)));
  const cn::Indices4 upper{first, first + 1, first + span, first + span + 1};
  const cn::Indices4 lower{first + half, first + half + 1, first + span + half, first + span + half + 1};
  const Butterflies4 narrow =
      butterflies(arguments, half, upper, every_second(wide, 0), every_second(wide, 1));
  arguments.data.store(upper, to_words(narrow.sum));
  arguments.data.store(lower, to_words(narrow.difference));
}

/// One stage on eight neighbours: of a span of 1, or of 16 or more.
inline void one_stage(const StageArguments& arguments, int span, int first) {
  const int step = span == 1 ? 2 : 1;
  const cn::Indices4 upper{first, first + step, first + 2 * step, first + 3 * step};
  const cn::Indices4 lower{first + span, first + step + span, first + 2 * step + span,
                           first + 3 * step + span};
  const Butterflies4 result = butterflies(arguments, span, upper, to_complex(arguments.data.load(upper)),
                                          to_complex(arguments.data.load(lower)));
  arguments.data.store(upper, to_words(result.sum));
  arguments.data.store(lower, to_words(result.difference));
}

/// The stages of spans 64 down to last_span: 1 transforms 128 numbers, 16 transforms 16 times 8 numbers.
inline void stages(const StageArguments& arguments) {
  int span = kOfPe / 2;
  for (; span / 2 >= arguments.last_span; span /= 4)
    for (int block = 0; block < kOfPe; block += 2 * span)
      for (int i = 0; i < span / 2; i += 2) two_stages(arguments, span, block + i);
  if (span < arguments.last_span) return;
  const int at_a_time = span == 1 ? 8 : 4;
  for (int block = 0; block < kOfPe; block += span == 1 ? 8 : 2 * span)
    for (int i = 0; i < (span == 1 ? 1 : span); i += at_a_time) one_stage(arguments, span, block + i);
}

struct ExchangeArguments {
  cn::PolyArray<std::uint64_t> data;
  cn::PolyArray<std::uint64_t> scratch;  ///< half as long
  int bit;  ///< of the PE's number; changes places with bit 4 + `bit` of the index
};

struct HalfPlaces {
  cn::Indices4 clear;  ///< indices with the bit clear
  cn::Indices4 set;    ///< the same with the bit set
};

inline HalfPlaces half_places(int first, int span) {
  HalfPlaces places;
  for (std::size_t i = 0; i < 4; ++i) {
    const int number = first + int(i);
    places.clear[i] = 2 * number - number % span;
    places.set[i] = places.clear[i] + span;
  }
  return places;
}

inline cn::mask has_bit(int bit) {
  using Number = cn::poly<std::int32_t>;
  return (cn::pe_num() & Number(1 << bit)) != Number(0);
}

/// PEs with the bit clear get their partners' numbers with the index bit clear, the others those with it set.
inline void exchange(const ExchangeArguments& arguments) {
  const cn::mask has = has_bit(arguments.bit);
  const int steps = 1 << arguments.bit;
  for (int i = 0; i < kOfPe / 2; i += 4) {
    const HalfPlaces at = half_places(i, kRun << arguments.bit);
    arguments.scratch.store(cn::four_from(i), select(has, arguments.data.load_and_swazzle(at.set, steps),
                                                     arguments.data.load_and_swazzle(at.clear, -steps)));
  }
}

inline void exchange_store(const ExchangeArguments& arguments) {
  const cn::mask has = has_bit(arguments.bit);
  for (int i = 0; i < kOfPe / 2; i += 4) {
    const HalfPlaces at = half_places(i, kRun << arguments.bit);
    const Words received = arguments.scratch.load(cn::four_from(i));
    cn::poly_if(
        has, [&] { arguments.data.store(at.clear, received); },
        [&] { arguments.data.store(at.set, received); });
  }
}

struct TurnArguments {
  cn::PolyArray<std::uint64_t> data;
  cn::PolyArray<std::uint64_t> factors;
};

/// Each PE multiplies its numbers by factors of its own.
inline void turn(const TurnArguments& arguments) {
  for (int i = 0; i < kOfPe; i += 4) {
    const Complex4 a = to_complex(arguments.data.load(cn::four_from(i)));
    const Complex4 w = to_complex(arguments.factors.load(cn::four_from(i)));
    arguments.data.store(cn::four_from(i),
                         to_words({multiply_subtract(a.real, w.real, a.imaginary * w.imaginary),
                                   multiply_add(a.real, w.imaginary, a.imaginary * w.real)}));
  }
}

struct PlaceArguments {
  cn::PolyField<cn::MonoAddress> input;    ///< of a PE's first piece, from the batch's first number
  cn::PolyField<cn::MonoAddress> factors;  ///< of a PE's factors
};

inline void places(const PlaceArguments& arguments) {
  using Number = cn::poly<std::int32_t>;
  constexpr int kBytes = sizeof(Complex);
  const Number in_group = cn::pe_num() & Number(kGroup - 1);
  const Number group = cn::pe_num() >> kGroupBits;
  arguments.input.write(
      cn::convert<cn::MonoAddress>(group * Number(kSize * kBytes) + in_group * Number(kRun * kBytes)));
  arguments.factors.write(cn::convert<cn::MonoAddress>(in_group * Number(kOfPe * kBytes)));
}

}  // namespace fft1d
