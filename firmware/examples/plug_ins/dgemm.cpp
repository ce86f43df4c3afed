// The plug-in dgemm: its kernels, of the level that this file is compiled for.

#include "firmware/examples/dgemm_kernel.hpp"
#include "firmware/examples/firmwares.hpp"

std::unique_ptr<plug_in::Firmware> plug_in::make_firmware() {
  using namespace examples;
  static const Kernels kernels = [] {
    Kernels made{};
    made.multiply_tiles = cn::kernel<MultiplyTilesArguments, multiply_tiles>("multiply_tiles");
    return made;
  }();
  return make_dgemm(kernels, validated_dgemm());
}
