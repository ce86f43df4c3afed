#include "testbench/run/chip_statistics.hpp"

#include "model/csx600.hpp"

namespace testbench {

double ChipStatistics::pe_utilisation() const {
  return firmware_cycles > 0 ? double(control[model::CycleCause::poly]) / double(firmware_cycles) : 0;
}

double ChipStatistics::exposed_pio_share() const {
  return firmware_cycles > 0 ? double(control.exposed_pio()) / double(firmware_cycles) : 0;
}

double ChipStatistics::ddr_bytes_per_second() const {
  return firmware_cycles > 0 ? double(ddr.bytes_read + ddr.bytes_written) / seconds() : 0;
}

ChipStatistics collect_statistics(const model::Csx600& chip, model::Cycles total_cycles) {
  ChipStatistics statistics;
  statistics.config = chip.config();
  statistics.firmware_cycles = chip.control_unit.now() - chip.control_unit.start_cycle();
  statistics.total_cycles = total_cycles;
  statistics.control = chip.control_unit.statistics();
  statistics.kernels = chip.pe_array.kernels();
  statistics.all_kernels = chip.pe_array.total();
  statistics.pio = chip.pio_engine.statistics();
  statistics.poly_sram = chip.poly_sram.statistics();
  statistics.ddr = chip.ddr_statistics();
  statistics.on_chip_sram = chip.on_chip_sram_statistics();
  statistics.bus_pio = chip.clear_connect.statistics(model::Initiator::pio);
  statistics.bus_control = chip.clear_connect.statistics(model::Initiator::control);
  statistics.bus_host = chip.clear_connect.statistics(model::Initiator::host);
  statistics.host_link = chip.host_link.statistics();
  return statistics;
}

}  // namespace testbench
