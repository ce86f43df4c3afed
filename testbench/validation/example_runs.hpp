#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "firmware/cn/machine.hpp"
#include "firmware/examples/dgemm.hpp"
#include "firmware/examples/monte_carlo.hpp"

namespace testbench {

/// One of the small firmwares with its input and the test of its output.
struct ExampleRun {
  std::vector<std::uint8_t> mono;  ///< mono memory before the run, from address 0
  std::function<void(cn::Machine&)> firmware;
  /// Throws RunError when mono memory does not hold what the firmware was to compute.
  std::function<void(const std::uint8_t* mono)> check;
  double work = 0;  ///< floating-point operations, or samples
};

/// C = A B of pseudo-random matrices. Every element must equal that of a plain product on the host
/// that sums in the same order (dgemm.hpp). `problem` gives the shape and the number of blocks; addresses are
/// set here. work: 2 M N K.
ExampleRun dgemm_run(examples::Dgemm::Problem problem, int num_pes, cn::Level level);

/// A European call option. The mean must lie within five standard errors of the Black-Scholes price.
/// `problem` gives all but addresses. work: samples.
ExampleRun monte_carlo_run(examples::MonteCarlo::Problem problem, int num_pes, cn::Level level);

/// `images` transforms of 512 x 512 pseudo-random complex numbers. Some outputs are compared with the sum
/// that defines them, and the energy of all with Parseval's theorem. work: 5 N log2 N an image, N = 512 x
/// 512, the usual count of FFT benchmarks.
ExampleRun fft_run(int images, cn::Level level);

}  // namespace testbench
