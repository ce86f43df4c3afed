#pragma once

#include "model/config/chip_config.hpp"

namespace test_support {

/// A small chip with round numbers, so that tests can compute cycles by hand: a cycle of 1 ns, 6 cycles from
/// an initiator to the DDR, links of 8 bytes per cycle, and a DDR of 16 bytes per cycle with 20 cycles for a
/// page hit and 30 for a miss.
inline model::ChipConfig test_chip(int pes = 8) {
  model::ChipConfig config{};
  config.preset = "test";
  config.chip = {1e9, pes, 1};
  config.board = {1, 8, 1e9, 20};
  config.poly.sram_bytes = 1024;
  config.poly.code_quality_factor = 1.0;
  config.poly.cycles.fill(1.0);
  config.control = {4096, 32, 25, 1, 0, 8, 0};
  config.pio.arbitration = model::PioArbitration::strict_fifo;
  config.pio.queue_depth = 2;
  config.pio.setup_cycles = 100;
  config.pio.per_pe_cycles = 10;
  config.pio.bytes_per_cycle = 8;
  config.pio.misalignment_cycles = 5;
  config.pio.consolidate_equal_addresses = false;
  config.pio.stolen_sram_cycles = 1;
  config.pio.outstanding_packets = 32;
  config.clear_connect.bytes_per_cycle = 8;
  config.clear_connect.packet_bytes = 64;
  config.clear_connect.hop_cycles = 2;
  config.clear_connect.hops_to_ddr = 3;
  config.ddr.size_bytes = 1 << 20;
  config.ddr.banks = 4;
  config.ddr.page_bytes = 512;
  config.ddr.bytes_per_cycle = 16;
  config.ddr.page_hit_cycles = 20;
  config.ddr.page_miss_cycles = 30;
  config.ddr.turn_round_cycles = 4;
  config.ddr.refresh_interval_cycles = 0;
  config.ddr.refresh_cycles = 0;
  config.ddr.ecc_cycles = 0;
  config.ddr.queue_transactions = 16;
  config.host.bytes_per_second = 1e9;
  config.host.latency_cycles = 1000;
  return config;
}

}  // namespace test_support
