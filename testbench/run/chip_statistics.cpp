#include "testbench/run/chip_statistics.hpp"

#include <algorithm>

#include "model/csx600.hpp"

namespace testbench {

namespace {

void merge_kernels(std::vector<model::KernelStatistics>& kernels,
                   const std::vector<model::KernelStatistics>& others) {
  for (const model::KernelStatistics& other : others) {
    const auto same = std::find_if(kernels.begin(), kernels.end(),
                                   [&](const auto& kernel) { return kernel.name == other.name; });
    if (same == kernels.end()) {
      kernels.push_back(other);
    } else {
      *same += other;
    }
  }
}

void merge(model::ControlStatistics& sum, const model::ControlStatistics& other) {
  for (std::size_t cause = 0; cause < sum.cycles.size(); ++cause) sum.cycles[cause] += other.cycles[cause];
  sum.mono_instructions += other.mono_instructions;
  sum.data_cache_hits += other.data_cache_hits;
  sum.data_cache_misses += other.data_cache_misses;
  sum.thread_switches += other.thread_switches;
}

void merge(model::PioStatistics& sum, const model::PioStatistics& other) {
  sum.requests_to_poly += other.requests_to_poly;
  sum.requests_to_mono += other.requests_to_mono;
  sum.bytes_to_poly += other.bytes_to_poly;
  sum.bytes_to_mono += other.bytes_to_mono;
  sum.pes += other.pes;
  sum.empty_requests += other.empty_requests;
  sum.setup_cycles += other.setup_cycles;
  sum.pe_cycles += other.pe_cycles;
  sum.memory_wait_cycles += other.memory_wait_cycles;
  sum.queue_wait_cycles += other.queue_wait_cycles;
  sum.blocked_cycles += other.blocked_cycles;
  sum.late_starts += other.late_starts;
  sum.max_queue_depth = std::max(sum.max_queue_depth, other.max_queue_depth);
}

void merge(model::PolySramStatistics& sum, const model::PolySramStatistics& other) {
  sum.words_in += other.words_in;
  sum.words_out += other.words_out;
  sum.port_cycles += other.port_cycles;
  sum.peak_bytes = std::max(sum.peak_bytes, other.peak_bytes);
}

void merge(model::ClearConnectStatistics& sum, const model::ClearConnectStatistics& other) {
  sum.bytes += other.bytes;
  sum.packets += other.packets;
  sum.waiting_cycles += other.waiting_cycles;
}

void merge(model::DdrStatistics& sum, const model::DdrStatistics& other) {
  sum.page_hits += other.page_hits;
  sum.page_misses += other.page_misses;
  sum.bytes_read += other.bytes_read;
  sum.bytes_written += other.bytes_written;
  sum.busy_cycles += other.busy_cycles;
  sum.turn_rounds += other.turn_rounds;
  sum.refreshes += other.refreshes;
}

void merge(model::OnChipSramStatistics& sum, const model::OnChipSramStatistics& other) {
  sum.accesses += other.accesses;
  sum.bytes_read += other.bytes_read;
  sum.bytes_written += other.bytes_written;
  sum.busy_cycles += other.busy_cycles;
}

void merge(model::SearchStatistics& sum, const model::SearchStatistics& other) {
  sum.queries += other.queries;
  sum.nodes += other.nodes;
  sum.leaves += other.leaves;
  sum.node_tests += other.node_tests;
  sum.leaf_tests += other.leaf_tests;
  sum.cache_hits += other.cache_hits;
  sum.cache_joins += other.cache_joins;
  sum.cache_misses += other.cache_misses;
  sum.bytes_fetched += other.bytes_fetched;
  sum.bytes_written += other.bytes_written;
  sum.bytes_read += other.bytes_read;
  sum.busy_cycles += other.busy_cycles;
  sum.stalled_cycles += other.stalled_cycles;
  sum.node_cycles += other.node_cycles;
  sum.leaf_cycles += other.leaf_cycles;
  sum.answer_wait_cycles += other.answer_wait_cycles;
}

void merge(model::HostLinkStatistics& sum, const model::HostLinkStatistics& other) {
  sum.bytes_uploaded += other.bytes_uploaded;
  sum.bytes_downloaded += other.bytes_downloaded;
  sum.transfers += other.transfers;
  sum.busy_cycles += other.busy_cycles;
}

/// What an array counts by itself: all but what it shares with the chip's other arrays.
ChipStatistics statistics_of_array(const model::Csx600& chip, const model::MtapArray& array) {
  ChipStatistics statistics;
  statistics.control = array.control_unit.statistics();
  statistics.kernels = array.pe_array.kernels();
  statistics.all_kernels = array.pe_array.total();
  statistics.pio = array.pio_engine.statistics();
  statistics.poly_sram = array.poly_sram.statistics();
  statistics.bus_pio = chip.clear_connect.statistics(array.pio);
  statistics.bus_control = chip.clear_connect.statistics(array.control);
  return statistics;
}

}  // namespace

void ChipStatistics::merge(const ChipStatistics& other) {
  testbench::merge(control, other.control);
  merge_kernels(kernels, other.kernels);
  all_kernels += other.all_kernels;
  testbench::merge(pio, other.pio);
  testbench::merge(poly_sram, other.poly_sram);
  testbench::merge(ddr, other.ddr);
  testbench::merge(on_chip_sram, other.on_chip_sram);
  testbench::merge(bus_pio, other.bus_pio);
  testbench::merge(bus_control, other.bus_control);
  testbench::merge(bus_host, other.bus_host);
  testbench::merge(search_unit, other.search_unit);
  testbench::merge(bus_search_unit, other.bus_search_unit);
  testbench::merge(host_link, other.host_link);
}

double ChipStatistics::pe_utilisation() const {
  return firmware_cycles > 0 ? double(control[model::CycleCause::poly]) / (double(firmware_cycles) * arrays())
                             : 0;
}

double ChipStatistics::exposed_pio_share() const {
  return firmware_cycles > 0 ? double(control.exposed_pio()) / (double(firmware_cycles) * arrays()) : 0;
}

double ChipStatistics::ddr_bytes_per_second() const {
  return firmware_cycles > 0 ? double(ddr.bytes_read + ddr.bytes_written) / seconds() : 0;
}

FirmwareSpan firmware_span(const model::Csx600& chip) {
  FirmwareSpan span{chip.control_unit.start_cycle(), chip.control_unit.now()};
  for (int i = 1; i < chip.arrays(); ++i) {
    const model::ControlUnit& other = chip.array(i).control_unit;
    span.start = std::min(span.start, other.start_cycle());
    span.end = std::max(span.end, other.now());
  }
  return span;
}

ChipStatistics collect_statistics(const model::Csx600& chip, model::Cycles total_cycles) {
  ChipStatistics statistics = statistics_of_array(chip, chip.array(0));
  for (int i = 1; i < chip.arrays(); ++i) statistics.merge(statistics_of_array(chip, chip.array(i)));
  statistics.config = chip.config();
  statistics.config.board.chips = 1;
  statistics.firmware_cycles = firmware_span(chip).cycles();
  statistics.total_cycles = total_cycles;
  statistics.ddr = chip.ddr_statistics();
  statistics.on_chip_sram = chip.on_chip_sram_statistics();
  statistics.bus_host = chip.clear_connect.statistics(model::Initiator::host);
  statistics.search_unit = chip.search_statistics();
  statistics.bus_search_unit = chip.search_unit_traffic();
  statistics.host_link = chip.host_link.statistics();
  return statistics;
}

}  // namespace testbench
