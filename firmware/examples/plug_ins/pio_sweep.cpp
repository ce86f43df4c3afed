// The plug-in pio_sweep, which runs no kernel.

#include "firmware/examples/firmwares.hpp"

std::unique_ptr<plug_in::Firmware> plug_in::make_firmware() {
  return examples::make_pio_sweep();
}
