#include "model/csx600.hpp"

#include <algorithm>
#include <string>

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
      arrays_(built_arrays()),
      pe_array(arrays_.front()->pe_array),
      control_unit(arrays_.front()->control_unit),
      poly_sram(arrays_.front()->poly_sram),
      pio_engine(arrays_.front()->pio_engine),
      clear_connect("clear_connect", config_, clock, event_queue.get()),
      mono_ddr(memory == MonoMemory::ddr
                   ? std::make_unique<MonoDdr>("mono_ddr", config_, clock, event_queue.get())
                   : nullptr),
      on_chip_sram(config_.on_chip_sram.size_bytes > 0
                       ? std::make_unique<OnChipSram>("on_chip_sram", config_, clock, event_queue.get())
                       : nullptr),
      search_unit(config_.search_unit.units > 0
                      ? std::make_unique<SearchUnit>("search_unit", config_, clock, event_queue.get())
                      : nullptr),
      host_link("host_link", config_, event_queue.get()) {
  host_link.socket.bind(clear_connect.host_socket);
  clear_connect.booked_traffic.bind(host_link.traffic);
  if (mono_ddr) clear_connect.ddr_socket.bind(mono_ddr->socket);
  if (on_chip_sram)
    clear_connect.bind(on_chip_sram->socket, kOnChipSramRange, on_chip_sram_range(config_),
                       {config_.on_chip_sram.bytes_per_cycle, config_.on_chip_sram.hops});
  for (const std::unique_ptr<MtapArray>& array : arrays_) join(*array);
  if (search_unit) join_search_unit();
  if (memory == MonoMemory::bound_outside || arrays() > 1) share_memory();
}

void Csx600::inject(std::vector<Fault> faults) {
  faults_ = std::make_unique<FaultInjector>(std::move(faults), control_unit.poly_memory(),
                                            FaultInjector::Ddr{mono_ddr->memory().data(), config_.ddr.ecc});
  control_unit.set_faults(faults_.get());
  pio_engine.set_faults(faults_.get());
  mono_ddr->set_faults(faults_.get());
}

void Csx600::share_memory() {
  for (const std::unique_ptr<MtapArray>& array : arrays_) array->control_unit.share_memory();
}

std::vector<std::unique_ptr<MtapArray>> Csx600::built_arrays() {
  std::vector<std::unique_ptr<MtapArray>> arrays;
  arrays.push_back(std::make_unique<MtapArray>("", config_, clock, event_queue.get()));
  for (int number = 1; number < config_.chip.arrays; ++number) {
    const std::string prefix = "array_" + std::to_string(number) + "_";
    if (event_queue)
      event_queues_of_arrays_.push_back(
          std::make_unique<EventQueue>((prefix + "event_queue").c_str(), *event_queue));
    arrays.push_back(std::make_unique<MtapArray>(
        prefix, config_, clock, event_queue ? event_queues_of_arrays_.back().get() : nullptr));
  }
  return arrays;
}

void Csx600::join(MtapArray& array) {
  if (&array == arrays_.front().get()) {
    array.control_unit.mono_socket.bind(clear_connect.control_socket);
    array.pio_engine.mono_socket.bind(clear_connect.pio_socket);
  } else {
    array.control = clear_connect.bind_initiator(array.control_unit.mono_socket);
    array.pio = clear_connect.bind_initiator(array.pio_engine.mono_socket);
  }
  array.control_unit.booked_traffic.bind(host_link.traffic);
  array.control_unit.follow(clear_connect.map());
  array.pio_engine.follow(clear_connect.map());
}

void Csx600::join_search_unit() {
  clear_connect.bind(search_unit->socket, kSearchUnitRange, search_unit_range(config_),
                     {config_.search_unit.bytes_per_cycle, config_.search_unit.hops});
  search_initiator_ = clear_connect.bind_initiator(search_unit->mono_socket);
  clear_connect.booked_traffic.bind(search_unit->traffic);
  control_unit.booked_traffic.bind(search_unit->traffic);
  control_unit.join(*search_unit);
}

std::unique_ptr<Bridge> join_by_bridge(Csx600& near, Csx600& far, cn::MonoAddress first) {
  std::string name = std::string(near.name()) + "_to_" + far.name();
  std::replace(name.begin(), name.end(), '.', '_');
  auto bridge = std::make_unique<Bridge>(name.c_str(), near.config(), near.event_queue.get());
  const ChipConfig& config = near.config();
  near.clear_connect.bind(bridge->near_socket, name, {first, far.config().ddr.size_bytes},
                          {config.board.bridge_bytes_per_cycle, config.clear_connect.hops_to_ddr});
  far.clear_connect.bind_initiator(bridge->far_socket);
  near.share_memory();
  far.share_memory();
  return bridge;
}

}  // namespace model
