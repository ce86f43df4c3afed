#include "testbench/chip_statistics.hpp"

#include <nlohmann/json.hpp>

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;

Json counts_json(const cn::IssueCounts& counts) {
  Json json = Json::object();
  for (std::size_t i = 0; i < cn::kInstructionClasses; ++i)
    if (counts.by_class[i] != 0) json[std::string(cn::kInstructionClassNames[i])] = counts.by_class[i];
  return json;
}

Json kernel_json(const model::KernelStatistics& kernel, int num_pes) {
  return {{"name", kernel.name},
          {"runs", kernel.runs},
          {"cycles", kernel.cycles},
          {"simd_efficiency", kernel.simd_efficiency(num_pes)},
          {"issued", counts_json(kernel.issued)}};
}

Json control_json(const model::ControlStatistics& control) {
  Json cycles = Json::object();
  for (int i = 0; i < model::kCycleCauses; ++i)
    cycles[model::cycle_cause_name(model::CycleCause(i))] = control.cycles[std::size_t(i)];
  return {{"cycles_by_cause", cycles},
          {"mono_instructions", control.mono_instructions},
          {"data_cache_hits", control.data_cache_hits},
          {"data_cache_misses", control.data_cache_misses}};
}

Json pio_json(const model::PioStatistics& pio) {
  return {{"requests_mono_to_poly", pio.requests_to_poly},
          {"requests_poly_to_mono", pio.requests_to_mono},
          {"empty_requests", pio.empty_requests},
          {"bytes_mono_to_poly", pio.bytes_to_poly},
          {"bytes_poly_to_mono", pio.bytes_to_mono},
          {"pes", pio.pes},
          {"busy_cycles", pio.busy_cycles()},
          {"setup_cycles", pio.setup_cycles},
          {"pe_cycles", pio.pe_cycles},
          {"memory_wait_cycles", pio.memory_wait_cycles},
          {"queue_wait_cycles", pio.queue_wait_cycles},
          {"max_queue_depth", pio.max_queue_depth}};
}

Json bus_json(const model::ClearConnectStatistics& bus) {
  return {{"bytes", bus.bytes}, {"packets", bus.packets}, {"waiting_cycles", bus.waiting_cycles}};
}

}  // namespace

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
  statistics.clock_hz = chip.config().chip.clock_hz;
  statistics.num_pes = chip.config().chip.pes;
  statistics.firmware_cycles = chip.control_unit.now() - chip.control_unit.start_cycle();
  statistics.total_cycles = total_cycles;
  statistics.control = chip.control_unit.statistics();
  statistics.kernels = chip.pe_array.kernels();
  statistics.all_kernels = chip.pe_array.total();
  statistics.pio = chip.dma_engine.statistics();
  statistics.poly_sram = chip.poly_sram.statistics();
  statistics.ddr = chip.ddr_statistics();
  statistics.bus_pio = chip.clear_connect.statistics(model::Initiator::pio);
  statistics.bus_control = chip.clear_connect.statistics(model::Initiator::control);
  statistics.host_link = chip.host_link.statistics();
  return statistics;
}

Json to_json(const ChipStatistics& statistics) {
  Json kernels = Json::array();
  for (const model::KernelStatistics& kernel : statistics.kernels)
    kernels.push_back(kernel_json(kernel, statistics.num_pes));
  const model::DdrStatistics& ddr = statistics.ddr;
  return {{"clock_hz", statistics.clock_hz},
          {"pes", statistics.num_pes},
          {"total_cycles", statistics.total_cycles},
          {"pe_utilisation", statistics.pe_utilisation()},
          {"simd_efficiency", statistics.simd_efficiency()},
          {"exposed_pio_share", statistics.exposed_pio_share()},
          {"ddr_bytes_per_second", statistics.ddr_bytes_per_second()},
          {"control_unit", control_json(statistics.control)},
          {"pe_array", {{"kernels", kernels}}},
          {"pio", pio_json(statistics.pio)},
          {"poly_sram",
           {{"peak_bytes", statistics.poly_sram.peak_bytes},
            {"words_in", statistics.poly_sram.words_in},
            {"words_out", statistics.poly_sram.words_out},
            {"port_cycles", statistics.poly_sram.port_cycles}}},
          {"clear_connect",
           {{"pio", bus_json(statistics.bus_pio)}, {"control", bus_json(statistics.bus_control)}}},
          {"ddr",
           {{"page_hits", ddr.page_hits},
            {"page_misses", ddr.page_misses},
            {"bytes_read", ddr.bytes_read},
            {"bytes_written", ddr.bytes_written},
            {"busy_cycles", ddr.busy_cycles},
            {"turn_rounds", ddr.turn_rounds},
            {"refreshes", ddr.refreshes}}},
          {"host_link",
           {{"bytes_uploaded", statistics.host_link.bytes_uploaded},
            {"bytes_downloaded", statistics.host_link.bytes_downloaded},
            {"host_dmas", statistics.host_link.host_dmas},
            {"busy_cycles", statistics.host_link.busy_cycles}}}};
}

Json to_json(const path_tracer::RunCounts& counts) {
  return {{"paths", counts.paths}, {"segments", counts.segments}, {"shadow_rays", counts.shadow_rays},
          {"folds", counts.folds}, {"blocks", counts.blocks},     {"skipped_blocks", counts.skipped_blocks},
          {"steps", counts.steps}};
}

}  // namespace testbench
