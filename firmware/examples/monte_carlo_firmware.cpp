#include <cmath>

#include "firmware/examples/firmwares.hpp"

namespace examples {
namespace {

double normal_cdf(double x) {
  return 0.5 * std::erfc(-x / std::sqrt(2.0));
}

/// Mean and standard deviation of the payoff at maturity, by Black and Scholes (1973) and the second moment
/// of a truncated log-normal distribution.
struct Payoff {
  double mean;
  double deviation;
};

Payoff expected_payoff(const MonteCarlo::Option& option) {
  const double diffusion = option.volatility * std::sqrt(option.maturity_years);
  const double growth = std::exp(option.rate * option.maturity_years);
  const double d2 =
      (std::log(option.spot / option.strike) + option.rate * option.maturity_years) / diffusion -
      diffusion / 2;
  const double forward = option.spot * growth;
  const double mean = forward * normal_cdf(d2 + diffusion) - option.strike * normal_cdf(d2);
  const double square = forward * forward * std::exp(diffusion * diffusion) * normal_cdf(d2 + 2 * diffusion) -
                        2 * option.strike * forward * normal_cdf(d2 + diffusion) +
                        option.strike * option.strike * normal_cdf(d2);
  return {mean, std::sqrt(square - mean * mean)};
}

class MonteCarloFirmware : public plug_in::Firmware {
 public:
  MonteCarloFirmware(const Kernels& kernels, const MonteCarlo::Problem& problem)
      : Firmware("Monte Carlo", "price of a European call option by simulation"),
        kernels_(kernels),
        runs_{*this, "kernels", problem.kernels, {1, 100000}, "runs of the kernel"},
        pairs_{*this, "pairs", problem.pairs_per_kernel, {1, 100000}, "pairs of samples a PE and kernel"},
        seed_{*this, "seed", std::int64_t(problem.seed), {0, 0xffffffff}, "of the random numbers"},
        spot_{*this, "spot", problem.option.spot, {0.01, 1e6}, "price today"},
        strike_{*this, "strike", problem.option.strike, {0.01, 1e6}, "price at which one may buy"},
        rate_{*this, "rate", problem.option.rate, {0, 1}, "of interest, a year"},
        volatility_{*this, "volatility", problem.option.volatility, {0.001, 2}, "a year"},
        maturity_years_{
            *this, "maturity_years", problem.option.maturity_years, {0.001, 100}, "until one may buy"} {}

  void prepare(int num_pes) override { sums_.resize(std::size_t(num_pes)); }
  void run(cn::Machine& machine) override { MonteCarlo(machine, kernels_, problem()).run(); }
  void check() const override {
    double sum = 0;
    for (const double pe_sum : sums_) sum += pe_sum;
    const Payoff expected = expected_payoff(problem().option);
    const double standard_error = expected.deviation / std::sqrt(work().amount);
    const double mean = sum / work().amount;
    mean_payoff_.set(mean);
    black_scholes_.set(expected.mean);
    if (!(std::abs(mean - expected.mean) <= 5 * standard_error))
      throw plug_in::CheckFailed("mean payoff " + std::to_string(mean) + ", Black-Scholes gives " +
                                 std::to_string(expected.mean) + " +- " + std::to_string(standard_error));
  }
  plug_in::Work work() const override { return {2.0 * pairs_ * runs_ * double(sums_.size()), "samples"}; }

 private:
  MonteCarlo::Problem problem() const {
    return {{spot_, strike_, rate_, volatility_, maturity_years_},
            std::uint32_t(seed_),
            runs_,
            pairs_,
            sums_.mono()};
  }

  const Kernels& kernels_;
  plug_in::Option<int> runs_, pairs_;
  plug_in::Option<std::int64_t> seed_;
  plug_in::Option<double> spot_, strike_, rate_, volatility_, maturity_years_;
  plug_in::MonoBuffer<double> sums_{*this, "sums", plug_in::Use::download};
  plug_in::Counter mean_payoff_{*this, "mean_payoff", "-", "mean of the payoffs at maturity"};
  plug_in::Counter black_scholes_{*this, "black_scholes_payoff", "-", "what that converges to"};
};

}  // namespace

std::unique_ptr<plug_in::Firmware> make_monte_carlo(const Kernels& kernels,
                                                    const MonteCarlo::Problem& problem) {
  return std::make_unique<MonteCarloFirmware>(kernels, problem);
}

}  // namespace examples
