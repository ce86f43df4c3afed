#pragma once

#include "firmware/cn/machine.hpp"
#include "firmware/examples/kernels.hpp"

namespace examples {

/// Price of a European call option by simulation: each PE samples prices at maturity independently.
class MonteCarlo {
 public:
  struct Option {
    double spot = 100;
    double strike = 105;
    double rate = 0.05;
    double volatility = 0.2;
    double maturity_years = 1;
  };
  struct Problem {
    Option option;
    std::uint32_t seed = 1;
    int kernels = 1;               ///< runs of the kernel
    int pairs_per_kernel = 64;     ///< pairs of samples for each PE
    cn::MonoPointer<double> sums;  ///< one for each PE: payoffs at maturity, not discounted
  };

  /// Throws cn::PolyMemoryOverflow.
  MonteCarlo(cn::Machine& machine, const Kernels& kernels, const Problem& problem);

  void run();

 private:
  cn::Machine& machine_;
  const Kernels& kernels_;
  Problem problem_;
  SeedRandomArguments random_;
  cn::PolySpan sum_;
  cn::Semaphore saved_;
};

}  // namespace examples
