#include "model/mtap_array.hpp"

namespace model {

MtapArray::MtapArray(const std::string& prefix, const ChipConfig& config, const ClockDomain& clock,
                     EventQueue* event_queue)
    : pe_array((prefix + "pe_array").c_str(), config),
      control_unit((prefix + "control_unit").c_str(), config, clock, pe_array, event_queue),
      poly_sram((prefix + "poly_sram").c_str(), config, control_unit.poly_memory()),
      pio_engine((prefix + "pio_engine").c_str(), config, clock, control_unit.poly_memory(), event_queue) {
  control_unit.pio.bind(pio_engine.port);
  pio_engine.semaphores.bind(control_unit.semaphores);
  pio_engine.time.bind(control_unit.time);
  pio_engine.poly_socket.bind(poly_sram.pio_socket);
}

}  // namespace model
