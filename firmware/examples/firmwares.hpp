#pragma once

#include <memory>

#include "firmware/examples/dgemm.hpp"
#include "firmware/examples/kernels.hpp"
#include "firmware/examples/monte_carlo.hpp"
#include "firmware/plug_in/firmware.hpp"

/// The examples with their options, their input and the check of their output, as `csx600 run` takes them.
/// `kernels` holds at least those that the firmware runs, and lives as long as the firmware.
namespace examples {

/// What csx600 validate runs: large enough for the published figures.
inline Dgemm::Problem validated_dgemm() {
  Dgemm::Problem problem;
  problem.column_blocks = 2;
  problem.panels = 60;
  return problem;
}
inline MonteCarlo::Problem validated_monte_carlo() {
  MonteCarlo::Problem problem;
  problem.kernels = 64;
  return problem;
}
inline constexpr int kValidatedFftImages = 4;

/// C = A B with pseudo-random matrices. Every element must equal that of a plain product that sums in the
/// same order (dgemm.hpp). work: 2 M N K floating-point operations.
/// @param problem defaults of the options; its addresses are not looked at
/// @param b_on_chip default of the option by which the rows of B that travel lie in the memory on the chip
std::unique_ptr<plug_in::Firmware> make_dgemm(const Kernels& kernels, const Dgemm::Problem& problem,
                                              bool b_on_chip = false);

/// `images` transforms of 512 x 512 pseudo-random complex numbers. Some outputs are compared with the sum
/// that defines them, and the energy of all outputs is compared by Parseval's theorem. work: 5 N log2 N
/// operations per image with N = 512 x 512, the usual count of FFT benchmarks.
std::unique_ptr<plug_in::Firmware> make_fft(const Kernels& kernels, int images);

/// The price of a European call option. The mean must lie within five standard errors of the Black-Scholes
/// price. work: the number of samples.
/// @param problem defaults of the options; its addresses are not looked at
std::unique_ptr<plug_in::Firmware> make_monte_carlo(const Kernels& kernels,
                                                    const MonteCarlo::Problem& problem);

/// y = factor y + x, again and again (stream.hpp), alone or with a thread for each direction. Every element
/// must equal that of a plain loop. work: 2 floating-point operations a step and element.
std::unique_ptr<plug_in::Firmware> make_stream(const Kernels& kernels);

/// The same transfer again and again (pio_sweep.hpp). What comes back must be what was sent. work: bytes.
std::unique_ptr<plug_in::Firmware> make_pio_sweep();

}  // namespace examples
