#include "model/memory/on_chip_sram.hpp"

#include <algorithm>
#include <cstring>

#include "model/time/annotated_delay.hpp"

namespace model {

OnChipSram::OnChipSram(const sc_core::sc_module_name& name, const ChipConfig& config,
                       const ClockDomain& clock, EventQueue* event_queue)
    : sc_module(name),
      clock_(clock),
      timing_(config.on_chip_sram),
      memory_(config.on_chip_sram.size_bytes),
      dmi_latency_cycles_(Cycles(config.on_chip_sram.latency_cycles)),
      event_queue_(event_queue) {
  socket.register_b_transport(this, &OnChipSram::b_transport);
  socket.register_transport_dbg(this, &OnChipSram::transport_dbg);
  socket.register_get_direct_mem_ptr(this, &OnChipSram::get_direct_mem_ptr);
  if (event_queue_ == nullptr) return;
  socket.register_nb_transport_fw(this, &OnChipSram::nb_transport_fw);
  at_target_.emplace(*event_queue_, AtTarget::Owner{[this](auto& transaction) { return take(transaction); },
                                                    [this](auto& transaction, auto& phase, auto& delay) {
                                                      return socket->nb_transport_bw(transaction, phase,
                                                                                     delay);
                                                    }});
}

void OnChipSram::b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay) {
  const Cycles over = serve(transaction, cycle_of_delay(clock_, delay));
  if (transaction.is_response_ok() && transaction.get_command() != tlm::TLM_IGNORE_COMMAND)
    delay = delay_until(clock_, over);
}

tlm::tlm_sync_enum OnChipSram::nb_transport_fw(tlm::tlm_generic_payload& transaction, tlm::tlm_phase& phase,
                                               sc_core::sc_time& delay) {
  return at_target_->nb_transport_fw(transaction, phase, delay);
}

Cycles OnChipSram::take(tlm::tlm_generic_payload& transaction) {
  const Cycles now = event_queue_->now();
  event_queue_->schedule(serve(transaction, now), [this, &transaction] { at_target_->respond(transaction); });
  return now;
}

Cycles OnChipSram::serve(tlm::tlm_generic_payload& transaction, Cycles arrival) {
  transaction.set_dmi_allowed(true);
  transaction.set_response_status(check(transaction));
  if (transaction.is_response_error() || transaction.get_command() == tlm::TLM_IGNORE_COMMAND) return arrival;
  move(transaction, transaction.get_data_length());
  return timing_.access(transaction.get_data_length(), transaction.is_write(), arrival).finish;
}

tlm::tlm_response_status OnChipSram::check(const tlm::tlm_generic_payload& transaction) const {
  if (transaction.get_command() == tlm::TLM_IGNORE_COMMAND) return tlm::TLM_OK_RESPONSE;
  const std::uint64_t address = transaction.get_address();
  const std::uint64_t bytes = transaction.get_data_length();
  if (address > memory_.size() || bytes > memory_.size() - address) return tlm::TLM_ADDRESS_ERROR_RESPONSE;
  if (transaction.get_byte_enable_ptr() != nullptr) return tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE;
  if (transaction.get_streaming_width() < bytes) return tlm::TLM_BURST_ERROR_RESPONSE;
  return tlm::TLM_OK_RESPONSE;
}

void OnChipSram::move(tlm::tlm_generic_payload& transaction, std::uint64_t bytes) {
  std::uint8_t* const storage = memory_.data() + transaction.get_address();
  if (transaction.is_write()) {
    std::memcpy(storage, transaction.get_data_ptr(), bytes);
  } else {
    std::memcpy(transaction.get_data_ptr(), storage, bytes);
  }
}

unsigned int OnChipSram::transport_dbg(tlm::tlm_generic_payload& transaction) {
  const std::uint64_t address = transaction.get_address();
  if (address >= memory_.size() || transaction.get_command() == tlm::TLM_IGNORE_COMMAND) return 0;
  const std::uint64_t bytes =
      std::min<std::uint64_t>(transaction.get_data_length(), memory_.size() - address);
  move(transaction, bytes);
  return static_cast<unsigned int>(bytes);
}

bool OnChipSram::get_direct_mem_ptr(tlm::tlm_generic_payload& transaction, tlm::tlm_dmi& dmi) {
  dmi.init();
  dmi.set_start_address(0);
  dmi.set_end_address(memory_.size() - 1);
  if (transaction.get_address() >= memory_.size()) return false;
  dmi.set_dmi_ptr(memory_.data());
  dmi.set_read_latency(clock_.time_at(dmi_latency_cycles_));
  dmi.set_write_latency(clock_.time_at(dmi_latency_cycles_));
  dmi.allow_read_write();
  return true;
}

}  // namespace model
