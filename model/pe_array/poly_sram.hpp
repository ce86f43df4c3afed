#pragma once

#include <tlm_utils/simple_target_socket.h>
#include <systemc>
#include <tlm>

#include "firmware/cn/chip/poly_memory.hpp"
#include "model/config/chip_config.hpp"
#include "model/pe_array/poly_sram_statistics.hpp"

namespace model {

/// The port side of the PEs' SRAM; the data are the machine's PolyMemory. `pio_socket` takes the PIO engine's
/// requests: TLM_IGNORE_COMMAND with PeAddresses, address = offset in the SRAM. It books port use and never
/// delays the engine. Reads and writes are answered with TLM_COMMAND_ERROR_RESPONSE: an SRAM has no address
/// in mono memory.
class PolySram : public sc_core::sc_module {
 public:
  tlm_utils::simple_target_socket<PolySram> pio_socket{"pio_socket"};

  PolySram(const sc_core::sc_module_name& name, const ChipConfig& config, const cn::PolyMemory& memory);

  int bytes_in_use() const { return memory_.used_bytes(); }
  /// The peak is sampled when programmed I/O takes a port, and now.
  PolySramStatistics statistics() const;

 private:
  void b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay);

  const cn::PolyMemory& memory_;
  std::uint64_t port_cycles_per_word_;
  PolySramStatistics statistics_;
};

}  // namespace model
