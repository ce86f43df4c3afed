// The plug-in monte_carlo: its kernels, of the level that this file is compiled for.

#include "firmware/examples/firmwares.hpp"
#include "firmware/examples/monte_carlo_kernels.hpp"

std::unique_ptr<plug_in::Firmware> plug_in::make_firmware() {
  using namespace examples;
  static const Kernels kernels = [] {
    Kernels made{};
    made.seed_random = cn::kernel<SeedRandomArguments, seed_random>("seed_random");
    made.sample_payoffs = cn::kernel<SamplePayoffsArguments, sample_payoffs>("sample_payoffs");
    return made;
  }();
  return make_monte_carlo(kernels, validated_monte_carlo());
}
