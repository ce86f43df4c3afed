#include "firmware/examples/monte_carlo.hpp"

#include <gtest/gtest.h>

#include "tests/support/native_example.hpp"

namespace monte_carlo_test {

using examples::MonteCarlo;
using test_support::run_natively;
using test_support::verdict;
using testbench::monte_carlo_run;

MonteCarlo::Problem problem(const MonteCarlo::Option& option = {}) {
  MonteCarlo::Problem problem;
  problem.option = option;
  problem.kernels = 20;
  return problem;
}

double mean_payoff(const testbench::ExampleRun& run, int num_pes) {
  const std::vector<std::uint8_t> mono = run_natively(run, num_pes);
  double sum = 0;
  for (int pe = 0; pe < num_pes; ++pe) {
    double of_pe;
    std::memcpy(&of_pe, mono.data() + 8 * pe, sizeof(of_pe));
    sum += of_pe;
  }
  return sum / run.work;
}

TEST(MonteCarloExample, AgreesWithBlackScholes) {
  const MonteCarlo::Option options[] = {{},
                                        {100, 100, 0.05, 0.2, 1},
                                        {100, 60, 0.01, 0.5, 0.25},
                                        {42, 40, 0.1, 0.2, 0.5},
                                        {100, 140, 0, 0.3, 2}};
  for (const MonteCarlo::Option& option : options) {
    const testbench::ExampleRun run = monte_carlo_run(problem(option), 96, cn::narrowest_level());
    EXPECT_EQ(verdict(run, run_natively(run, 96)), "") << option.strike;
  }
}

/// Hull, "Options, Futures, and Other Derivatives": spot 42, strike 40, 10 %, 20 %, half a year: 4.76.
TEST(MonteCarloExample, AgreesWithATextbookPrice) {
  MonteCarlo::Problem of = problem({42, 40, 0.1, 0.2, 0.5});
  of.kernels = 200;
  const double price = mean_payoff(monte_carlo_run(of, 96, cn::narrowest_level()), 96) * std::exp(-0.1 * 0.5);
  EXPECT_NEAR(price, 4.76, 0.02);
}

TEST(MonteCarloExample, SeedsGiveDifferentSamples) {
  MonteCarlo::Problem other = problem();
  other.seed = 2;
  EXPECT_NE(mean_payoff(monte_carlo_run(problem(), 96, cn::narrowest_level()), 96),
            mean_payoff(monte_carlo_run(other, 96, cn::narrowest_level()), 96));
}

TEST(MonteCarloExample, CutIntoKernelsOfAnyLengthItDrawsTheSameSamples) {
  MonteCarlo::Problem few = problem();
  few.kernels = 4;
  few.pairs_per_kernel = 320;
  EXPECT_EQ(run_natively(monte_carlo_run(few, 32, cn::narrowest_level()), 32),
            run_natively(monte_carlo_run(problem(), 32, cn::narrowest_level()), 32));
}

TEST(MonteCarloExample, LevelsGiveTheSameBits) {
  const auto first = run_natively(monte_carlo_run(problem(), 96, cn::narrowest_level()), 96);
  for (const cn::Level level : cn::usable_levels())
    EXPECT_EQ(run_natively(monte_carlo_run(problem(), 96, level), 96), first);
}

TEST(MonteCarloExample, CheckNoticesABiasOfTwoPercent) {
  MonteCarlo::Problem of = problem();
  of.kernels = 200;
  const testbench::ExampleRun run = monte_carlo_run(of, 96, cn::narrowest_level());
  std::vector<std::uint8_t> mono = run_natively(run, 96);
  for (int pe = 0; pe < 96; ++pe) {
    double sum;
    std::memcpy(&sum, mono.data() + 8 * pe, sizeof(sum));
    sum *= 1.02;
    std::memcpy(mono.data() + 8 * pe, &sum, sizeof(sum));
  }
  EXPECT_NE(verdict(run, mono).find("Monte Carlo: mean payoff"), std::string::npos);
}

}  // namespace monte_carlo_test
