#pragma once

#include "firmware/cn/chip/mono_memory.hpp"
#include "firmware/cn/language/kernel.hpp"
#include "firmware/cn/language/poly4.hpp"
#include "firmware/cn/simd/level.hpp"

/// Small programs that show other uses of the chip than ray tracing. This file declares the arguments of
/// their poly programs.
namespace examples {

using cn::PolyArray;
using cn::PolyField;
using cn::PolyPointer;

/// C += A B for some tiles of 2 rows and 4 columns; B passes along the path.
struct MultiplyTilesArguments {
  PolyArray<double> a;           ///< [depth][row]
  PolyArray<double> b_in_place;  ///< [tile][column]: where the path left off
  PolyArray<double> b_fed;       ///< in the feeders: [tile of these][depth / feeders][column]
  PolyArray<double> c;           ///< [tile][row][column]
  int first_tile = 0;
  int tiles = 0;
  int depth = 0;       ///< a multiple of the feeders
  bool first = false;  ///< C starts from zero
};

struct SeedRandomArguments {
  PolyField<std::uint32_t> word[3];
  std::uint32_t seed = 0;
};

/// Payoffs of a European call option whose price follows a geometric Brownian motion.
struct SamplePayoffsArguments {
  PolyField<std::uint32_t> word[3];
  PolyField<double> sum;
  int pairs = 0;  ///< number of pairs of samples
  double spot = 0;
  double strike = 0;
  double drift = 0;      ///< (rate - volatility^2 / 2) maturity
  double diffusion = 0;  ///< volatility sqrt(maturity)
};

/// y = factor y + x, `steps` times
struct ScaleAndAddArguments {
  PolyArray<double> x;
  PolyArray<double> y;
  double factor = 0;
  int steps = 0;
  int elements = 0;  ///< a multiple of 4
};

/// A complex number as SRAM and mono memory hold it.
struct Complex {
  float real = 0;
  float imaginary = 0;
};

/// One step of the FFT on the 256 complex numbers of each PE.
struct FftArguments {
  PolyArray<std::uint64_t> data;
  PolyArray<std::uint64_t> scratch;   ///< half as long
  const Complex* twiddles = nullptr;  ///< mono: exp(-2 pi i k / 512), k = 0..255
  bool from_reversed = false;         ///< local: bit-reversed order to natural, else back
  int half = 0;                       ///< 0 or 1; for steps that need scratch for all data
  int pe_bit = 0;                     ///< exchange: bit of the PE's number
  int index_bit = 0;                  ///< exchange: bit of the index in `data`
};

/// Byte offsets of each PE's piece in the FFT's mono arrays.
struct FftPlacesArguments {
  PolyField<cn::MonoAddress> tile_save;
  PolyField<cn::MonoAddress> tile_load;
  PolyField<cn::MonoAddress> result;
};

struct Kernels {
  cn::Kernel<MultiplyTilesArguments> multiply_tiles;
  cn::Kernel<SeedRandomArguments> seed_random;
  cn::Kernel<SamplePayoffsArguments> sample_payoffs;
  cn::Kernel<ScaleAndAddArguments> scale_and_add;
  cn::Kernel<FftPlacesArguments> fft_places;
  cn::Kernel<FftArguments> fft_local;
  cn::Kernel<FftArguments> fft_twiddle;
  cn::Kernel<FftArguments> fft_pair;
  cn::Kernel<FftArguments> fft_pair_store;
  cn::Kernel<FftArguments> fft_exchange;
  cn::Kernel<FftArguments> fft_exchange_store;
};

const Kernels& kernels(cn::Level level);

/// Kernels built to report their SRAM accesses to a cn::AccessObserver; they run on every x86-64 machine of
/// this build.
const Kernels& observed_kernels();

}  // namespace examples
