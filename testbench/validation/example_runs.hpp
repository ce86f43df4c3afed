#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "firmware/cn/machine.hpp"
#include "firmware/examples/dgemm.hpp"
#include "firmware/examples/monte_carlo.hpp"

namespace testbench {

/// One of the example firmwares with its input and the check of its output.
struct ExampleRun {
  std::vector<std::uint8_t> mono;        ///< mono memory before the run, from address 0
  std::vector<std::uint8_t> scratchpad;  ///< cn::Machine::scratchpad() before the run, from its start
  std::function<void(cn::Machine&)> firmware;
  /// Throws RunError if mono memory does not hold the right results.
  std::function<void(const std::uint8_t* mono)> check;
  double work = 0;  ///< number of floating-point operations, or of samples
};

/// C = A B with pseudo-random matrices. Every element must equal that of a plain product that sums in the
/// same order (dgemm.hpp). `problem` gives the shape and the number of blocks; addresses are set here. work:
/// 2 M N K operations.
/// @param scratchpad if it has bytes, the rows of B that travel down the path lie there. Throws InputError if
///   they do not fit.
ExampleRun dgemm_run(examples::Dgemm::Problem problem, int num_pes, cn::Level level,
                     const cn::MonoRange& scratchpad = {});

/// The price of a European call option. The mean must lie within five standard errors of the Black-Scholes
/// price. `problem` gives everything but the addresses. work: the number of samples.
ExampleRun monte_carlo_run(examples::MonteCarlo::Problem problem, int num_pes, cn::Level level);

/// `images` transforms of 512 x 512 pseudo-random complex numbers. Some outputs are compared with the sum
/// that defines them, and the energy of all outputs is compared by Parseval's theorem. work: 5 N log2 N
/// operations per image with N = 512 x 512, the usual count of FFT benchmarks.
ExampleRun fft_run(int images, cn::Level level);

}  // namespace testbench
