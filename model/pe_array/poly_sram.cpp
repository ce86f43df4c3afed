#include "model/pe_array/poly_sram.hpp"

#include <algorithm>

#include "model/transaction/pe_addresses.hpp"

namespace model {

PolySram::PolySram(const sc_core::sc_module_name& name, const ChipConfig& config,
                   const cn::PolyMemory& memory)
    : sc_module(name), memory_(memory), port_cycles_per_word_(std::uint64_t(config.pio.stolen_sram_cycles)) {
  pio_socket.register_b_transport(this, &PolySram::b_transport);
}

PolySramStatistics PolySram::statistics() const {
  PolySramStatistics statistics = statistics_;
  statistics.peak_bytes = std::max(statistics.peak_bytes, memory_.used_bytes());
  return statistics;
}

void PolySram::b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time&) {
  PeAddresses* const addresses = transaction.get_extension<PeAddresses>();
  if (transaction.is_read() || transaction.is_write() || addresses == nullptr) {
    transaction.set_response_status(tlm::TLM_COMMAND_ERROR_RESPONSE);
    return;
  }
  const MonoPieces& pieces = addresses->pieces;
  const std::uint64_t bytes_per_pe = std::uint64_t(pieces.bytes_per_pe());
  const auto sram_bytes = std::uint64_t(memory_.capacity_bytes() + cn::PolyMemory::kReservedBytes);
  if (transaction.get_address() > sram_bytes || bytes_per_pe > sram_bytes - transaction.get_address()) {
    transaction.set_response_status(tlm::TLM_ADDRESS_ERROR_RESPONSE);
    return;
  }
  // A consolidated word is broadcast: it takes the ports of several PEs in the same cycle.
  (pieces.write() ? statistics_.words_out : statistics_.words_in) += pieces.poly_bytes() / 8;
  statistics_.port_cycles += pieces.mono_bytes() / 8 * port_cycles_per_word_;
  statistics_.peak_bytes = std::max(statistics_.peak_bytes, memory_.used_bytes());
  addresses->served = true;
  transaction.set_response_status(tlm::TLM_OK_RESPONSE);
}

}  // namespace model
