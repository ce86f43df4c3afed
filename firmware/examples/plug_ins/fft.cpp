// The plug-in fft: its kernels, of the level that this file is compiled for.

#include "firmware/examples/fft_kernels.hpp"
#include "firmware/examples/firmwares.hpp"

std::unique_ptr<plug_in::Firmware> plug_in::make_firmware() {
  using namespace examples;
  static const Kernels kernels = [] {
    Kernels made{};
    made.fft_places = cn::kernel<FftPlacesArguments, fft_places>("fft_places");
    made.fft_local = cn::kernel<FftArguments, fft_local>("fft_local");
    made.fft_twiddle = cn::kernel<FftArguments, fft_twiddle>("fft_twiddle");
    made.fft_pair = cn::kernel<FftArguments, fft_pair>("fft_pair");
    made.fft_pair_store = cn::kernel<FftArguments, fft_pair_store>("fft_pair_store");
    made.fft_exchange = cn::kernel<FftArguments, fft_exchange>("fft_exchange");
    made.fft_exchange_store = cn::kernel<FftArguments, fft_exchange_store>("fft_exchange_store");
    return made;
  }();
  return make_fft(kernels, kValidatedFftImages);
}
