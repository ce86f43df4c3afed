#include "firmware/examples/monte_carlo.hpp"

#include <cmath>

#include "firmware/examples/mono_cost.hpp"

namespace examples {

MonteCarlo::MonteCarlo(cn::Machine& machine, const Kernels& kernels, const Problem& problem)
    : machine_(machine), kernels_(kernels), problem_(problem) {
  const int state = machine.poly_memory().allocate("random state", 3 * 4).offset_bytes;
  for (int i = 0; i < 3; ++i) random_.word[i] = {state + 4 * i};
  random_.seed = problem.seed;
  sum_ = machine.poly_memory().allocate("sum", sizeof(double));
  saved_ = machine.allocate_semaphore("saved");
}

void MonteCarlo::run() {
  const cn::LaneMask all = cn::LaneMask::first(machine_.num_pes());
  machine_.run(kernels_.seed_random, random_, all);
  const Option& option = problem_.option;
  SamplePayoffsArguments arguments;
  for (int i = 0; i < 3; ++i) arguments.word[i] = random_.word[i];
  arguments.sum = {sum_.offset_bytes};
  arguments.spot = option.spot;
  arguments.strike = option.strike;
  arguments.drift = (option.rate - 0.5 * option.volatility * option.volatility) * option.maturity_years;
  arguments.diffusion = option.volatility * std::sqrt(option.maturity_years);
  arguments.pairs = problem_.pairs_per_kernel;
  for (int i = 0; i < problem_.kernels; ++i) machine_.run(kernels_.sample_payoffs, arguments, all);
  machine_.issue_mono(kRequestInstructions);
  machine_.async_copy_p2m(saved_, cn::MonoPlaces::array(problem_.sums.address, sizeof(double)), sum_, all);
  machine_.sem_wait(saved_);
}

}  // namespace examples
