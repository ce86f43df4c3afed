#include "model/csx600.hpp"

namespace model {
namespace {

std::unique_ptr<EventQueue> event_queue_for(TimingStyle timing, const ClockDomain& clock) {
  return timing == TimingStyle::approximately_timed ? std::make_unique<EventQueue>("event_queue", clock)
                                                    : nullptr;
}

}  // namespace

Csx600::Csx600(const sc_core::sc_module_name& name, const ChipConfig& config, TimingStyle timing,
               MonoMemory memory)
    : sc_module(name),
      config_(config),
      clock(config.chip.clock_hz),
      event_queue(event_queue_for(timing, clock)),
      pe_array("pe_array", config_),
      control_unit("control_unit", config_, clock, pe_array, event_queue.get()),
      poly_sram("poly_sram", config_, control_unit.poly_memory()),
      pio_engine("pio_engine", config_, clock, control_unit.poly_memory(), event_queue.get()),
      clear_connect("clear_connect", config_, clock, event_queue.get()),
      mono_ddr(memory == MonoMemory::ddr
                   ? std::make_unique<MonoDdr>("mono_ddr", config_, clock, event_queue.get())
                   : nullptr),
      on_chip_sram(config_.on_chip_sram.size_bytes > 0
                       ? std::make_unique<OnChipSram>("on_chip_sram", config_, clock, event_queue.get())
                       : nullptr),
      host_link("host_link", config_, event_queue.get()) {
  control_unit.pio.bind(pio_engine.port);
  control_unit.mono_socket.bind(clear_connect.control_socket);
  pio_engine.semaphores.bind(control_unit.semaphores);
  pio_engine.time.bind(control_unit.time);
  pio_engine.mono_socket.bind(clear_connect.pio_socket);
  pio_engine.poly_socket.bind(poly_sram.pio_socket);
  host_link.socket.bind(clear_connect.host_socket);
  clear_connect.host_traffic.bind(host_link.traffic);
  control_unit.host_traffic.bind(host_link.traffic);
  if (mono_ddr) {
    clear_connect.ddr_socket.bind(mono_ddr->socket);
  } else {
    control_unit.share_memory();
  }
  if (on_chip_sram)
    clear_connect.bind(on_chip_sram->socket, kOnChipSramRange, on_chip_sram_range(config_),
                       {config_.on_chip_sram.bytes_per_cycle, config_.on_chip_sram.hops});
  control_unit.follow(clear_connect.map());
  pio_engine.follow(clear_connect.map());
}

}  // namespace model
