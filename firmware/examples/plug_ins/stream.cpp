// The plug-in stream: its kernels, of the level that this file is compiled for.

#include "firmware/examples/firmwares.hpp"
#include "firmware/examples/stream_kernel.hpp"

std::unique_ptr<plug_in::Firmware> plug_in::make_firmware() {
  using namespace examples;
  static const Kernels kernels = [] {
    Kernels made{};
    made.scale_and_add = cn::kernel<ScaleAndAddArguments, scale_and_add>("scale_and_add");
    return made;
  }();
  return make_stream(kernels);
}
