// Built once for each x86-64 level; EXAMPLES_KERNELS is the level's name for the table.

#include "firmware/examples/kernels.hpp"

#include "firmware/examples/dgemm_kernel.hpp"
#include "firmware/examples/fft_kernels.hpp"
#include "firmware/examples/monte_carlo_kernels.hpp"
#include "firmware/examples/stream_kernel.hpp"

namespace examples {
namespace {

template <class Arguments, void (*program)(const Arguments&)>
constexpr cn::Kernel<Arguments> kernel(const char* name) {
  return {name, &cn::run_strips<Arguments, program>};
}

}  // namespace

const Kernels& EXAMPLES_KERNELS() {
  static constexpr Kernels table{
      kernel<MultiplyTilesArguments, multiply_tiles>("multiply_tiles"),
      kernel<SeedRandomArguments, seed_random>("seed_random"),
      kernel<SamplePayoffsArguments, sample_payoffs>("sample_payoffs"),
      kernel<ScaleAndAddArguments, scale_and_add>("scale_and_add"),
      kernel<FftPlacesArguments, fft_places>("fft_places"),
      kernel<FftArguments, fft_local>("fft_local"),
      kernel<FftArguments, fft_twiddle>("fft_twiddle"),
      kernel<FftArguments, fft_pair>("fft_pair"),
      kernel<FftArguments, fft_pair_store>("fft_pair_store"),
      kernel<FftArguments, fft_exchange>("fft_exchange"),
      kernel<FftArguments, fft_exchange_store>("fft_exchange_store"),
  };
  return table;
}

}  // namespace examples
