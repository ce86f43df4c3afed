// Built once for each x86-64 level, whose name is the namespace of the table.

#include "firmware/examples/kernels.hpp"

#include "firmware/examples/dgemm_kernel.hpp"
#include "firmware/examples/fft_kernels.hpp"
#include "firmware/examples/monte_carlo_kernels.hpp"
#include "firmware/examples/stream_kernel.hpp"

namespace examples {
inline namespace CN_LEVEL {

const Kernels& kernel_table() {
  static constexpr Kernels table{
      cn::kernel<MultiplyTilesArguments, multiply_tiles>("multiply_tiles"),
      cn::kernel<SeedRandomArguments, seed_random>("seed_random"),
      cn::kernel<SamplePayoffsArguments, sample_payoffs>("sample_payoffs"),
      cn::kernel<ScaleAndAddArguments, scale_and_add>("scale_and_add"),
      cn::kernel<FftPlacesArguments, fft_places>("fft_places"),
      cn::kernel<FftArguments, fft_local>("fft_local"),
      cn::kernel<FftArguments, fft_twiddle>("fft_twiddle"),
      cn::kernel<FftArguments, fft_pair>("fft_pair"),
      cn::kernel<FftArguments, fft_pair_store>("fft_pair_store"),
      cn::kernel<FftArguments, fft_exchange>("fft_exchange"),
      cn::kernel<FftArguments, fft_exchange_store>("fft_exchange_store"),
  };
  return table;
}

}  // namespace CN_LEVEL
}  // namespace examples
