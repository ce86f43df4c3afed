#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "firmware/cn/chip/instruction.hpp"

namespace model {

enum class PioArbitration : std::uint8_t { strict_fifo, reads_overtake_writes, queue_per_direction };

/// Every number of the chip, and of the board that it is on. Defaults, units, meaning, range, confidence and
/// source of each are in the parameter table (chip_parameters.hpp), which is the only place that knows the
/// keys.
struct ChipConfig {
  std::string preset;

  struct Chip {
    double clock_hz;
    int pes;     ///< of an array
    int arrays;  ///< each with a control unit and a PIO engine of its own, on one network
    std::uint64_t watchdog_cycles = 0;  ///< the longest that firmware may run; 0: no watchdog
  } chip;

  struct Poly {
    int sram_bytes;
    double code_quality_factor;  ///< cycles of code = this x (instructions . cost table)
    bool vector_loads_overlap;   ///< vector loads run beside vector arithmetic of the same kernel
    std::array<double, cn::kInstructionClasses> cycles;  ///< by instruction class; `sram` is per 4-byte word
  } poly;

  struct Control {
    int data_cache_bytes;
    int cache_line_bytes;
    int cache_miss_cycles;     ///< cost in the control unit, on top of what the memory takes
    int semaphore_cycles;      ///< a signal or an unblocked wait
    int transfer_call_cycles;  ///< software that starts an asynchronous copy
    int threads;               ///< hardware threads, the firmware's first one included
    int thread_switch_cycles;  ///< a switch from one hardware thread to another
  } control;

  struct Pio {
    PioArbitration arbitration;
    int queue_depth;
    int setup_cycles;         ///< a request
    int per_pe_cycles;        ///< a participating PE
    int bytes_per_cycle;      ///< into or out of one PE
    int misalignment_cycles;  ///< a PE whose piece is off 8 bytes or spread over more packets than it needs
    bool consolidate_equal_addresses;
    int stolen_sram_cycles;   ///< SRAM port cycles taken for 8 bytes
    int outstanding_packets;  ///< at most so many on the way; loosely timed there is no bound
  } pio;

  struct ClearConnect {
    int bytes_per_cycle;
    int packet_bytes;
    int hop_cycles;
    int hops_to_ddr;
    int ddr_port_bytes_per_cycle;  ///< 0: as wide as the DDR
  } clear_connect;

  struct Ddr {
    std::uint64_t size_bytes;
    int banks;
    int page_bytes;
    int bytes_per_cycle;
    int page_hit_cycles;
    int page_miss_cycles;
    int turn_round_cycles;
    int refresh_interval_cycles;  ///< 0: no refresh
    int refresh_cycles;
    int ecc_cycles;          ///< added to each access
    int queue_transactions;  ///< at most so many at a time; loosely timed there is no bound
    bool ecc = true;         ///< felt by faults only (model/faults)
  } ddr;

  /// Memory on the chip that all units reach over the network. No bytes: the chip has none.
  struct OnChipSram {
    std::uint64_t size_bytes;
    std::uint64_t first_address;  ///< mono address of its first byte
    int bytes_per_cycle;
    int latency_cycles;  ///< from the arrival of a request to its first byte
    int hops;            ///< from an initiator to its port of the network
  } on_chip_sram;

  /// A fixed-function unit that searches structures in mono memory for the PEs (cn::SearchFunction). No
  /// units: the chip has none. Cycles are the unit's own but for its port and its distance.
  struct SearchUnit {
    int units;
    int width;                 ///< boxes that a unit tests at a time
    int queries_in_flight;     ///< of each unit
    int node_cycles;           ///< from the start of a node's last test to its result
    int leaf_cycles;           ///< the same for leaves
    int leaf_interval_cycles;  ///< from the start of a leaf's test to that of the next
    int clock_divider;         ///< cycles of the chip a cycle of the unit
    int cache_bytes;           ///< of each unit
    int cache_line_bytes;
    int cache_ways;
    int cache_hit_cycles;
    std::uint64_t buffer_bytes;  ///< of queries and answers, for all units together
    std::uint64_t first_address;
    int bytes_per_cycle;
    int hops;
  } search_unit;

  /// The chips behind one host link, in a row: the link ends at the first, and bridges join neighbours.
  struct Board {
    int chips;
    int bridge_bytes_per_cycle;  ///< each way
    double bridge_clock_hz;
    int bridge_latency_cycles;  ///< of the bridge's clock
  } board;

  struct Host {
    double bytes_per_second;
    int latency_cycles;  ///< before the bytes of each of the host's DMAs
  } host;

  /// The process in which the chip is made. Only energy and area depend on it: clocks are set apart.
  struct Technology {
    int node_nm;
    double voltage_v;  ///< of the chip's core
  } technology;

  /// Energy to first order: after a run, counters are multiplied by these. No cycle depends on them.
  struct Energy {
    double chip_scale;  ///< factor for all on-chip picojoules below
    std::array<double, cn::kInstructionClasses>
        picojoules;                           ///< an instruction of an enabled PE, by class; `mono` is unused
    double pe_clock_picojoules;               ///< a PE and cycle, enabled or not
    double control_unit_picojoules;           ///< a cycle that the control unit does not wait
    double pio_picojoules_per_byte;           ///< moved by the PIO engine
    double clear_connect_picojoules;          ///< a byte and hop
    double on_chip_sram_picojoules_per_byte;  ///< read or written
    double search_box_picojoules;             ///< a test of a box by a search unit
    double search_leaf_picojoules;            ///< a test of a leaf's triangle by a search unit
    double search_line_picojoules;            ///< a line looked up in a search unit's cache, or brought there
    double search_picojoules_per_byte;        ///< read from or written to a search unit's buffer
    double search_clock_picojoules;           ///< a search unit and cycle, busy or not
    double search_leakage_watts;              ///< of each search unit, with its cache
    double leakage_watts_per_pe;              ///< of a PE with an SRAM of the CSX600's size
    double leakage_watts;                     ///< everything but the PEs
    double sram_leakage_watts_per_kib;        ///< of SRAM beyond that of the CSX600
    double ddr_activate_picojoules;           ///< a page miss
    double ddr_read_picojoules;               ///< a byte
    double ddr_write_picojoules;              ///< a byte
    double ddr_refresh_picojoules;            ///< a refresh
    double ddr_background_watts;
  } energy;

  /// Area to first order. Nothing else depends on it.
  struct Area {
    double pe_mm2;            ///< a PE with an SRAM of the CSX600's size and its part of the array's wires
    double rest_mm2;          ///< everything but PEs and search units
    double search_box_mm2;    ///< what tests a box at a time
    double search_leaf_mm2;   ///< what begins a test of a triangle each cycle
    double search_query_mm2;  ///< state of a query in flight
    double sram_mm2_per_kib;  ///< of the SRAMs of PEs, of on_chip_sram, caches and buffers of search units
  } area;
};

}  // namespace model
