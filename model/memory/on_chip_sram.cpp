#include "model/memory/on_chip_sram.hpp"

#include "model/memory/plain_access.hpp"
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
  const bool is_access = transaction.get_command() != tlm::TLM_IGNORE_COMMAND;
  transaction.set_response_status(is_access ? check_access(transaction, memory_.size())
                                            : tlm::TLM_OK_RESPONSE);
  if (!is_access || transaction.is_response_error()) return arrival;
  move_data(transaction, memory_.data(), transaction.get_data_length());
  return timing_.access(transaction.get_data_length(), transaction.is_write(), arrival).finish;
}

unsigned int OnChipSram::transport_dbg(tlm::tlm_generic_payload& transaction) {
  return move_for_debug(transaction, memory_.data(), memory_.size());
}

bool OnChipSram::get_direct_mem_ptr(tlm::tlm_generic_payload& transaction, tlm::tlm_dmi& dmi) {
  return give_pointer(transaction, dmi, memory_.data(), memory_.size(), clock_.time_at(dmi_latency_cycles_));
}

}  // namespace model
