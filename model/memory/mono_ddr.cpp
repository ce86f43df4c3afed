#include "model/memory/mono_ddr.hpp"

#include "model/faults/fault_injector.hpp"
#include "model/memory/plain_access.hpp"
#include "model/time/annotated_delay.hpp"

namespace model {

MonoDdr::MonoDdr(const sc_core::sc_module_name& name, const ChipConfig& config, const ClockDomain& clock,
                 EventQueue* event_queue)
    : sc_module(name),
      clock_(clock),
      timing_(config.ddr),
      memory_(config.ddr.size_bytes),
      dmi_latency_cycles_(Cycles(config.ddr.page_hit_cycles)),
      event_queue_(event_queue),
      queue_transactions_(config.ddr.queue_transactions) {
  socket.register_b_transport(this, &MonoDdr::b_transport);
  socket.register_transport_dbg(this, &MonoDdr::transport_dbg);
  socket.register_get_direct_mem_ptr(this, &MonoDdr::get_direct_mem_ptr);
  if (event_queue_ == nullptr) return;
  socket.register_nb_transport_fw(this, &MonoDdr::nb_transport_fw);
  at_target_.emplace(*event_queue_, AtTarget::Owner{[this](auto& transaction) { return take(transaction); },
                                                    [this](auto& transaction, auto& phase, auto& delay) {
                                                      return socket->nb_transport_bw(transaction, phase,
                                                                                     delay);
                                                    }});
}

void MonoDdr::b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay) {
  transaction.set_dmi_allowed(true);
  if (!transaction.is_read() && !transaction.is_write()) {
    PeAddresses* const addresses = transaction.get_extension<PeAddresses>();
    transaction.set_response_status(addresses == nullptr ? tlm::TLM_OK_RESPONSE : serve(*addresses, delay));
    return;
  }
  Cycles finish = 0;
  transaction.set_response_status(access_plainly(transaction, cycle_of_delay(clock_, delay), finish));
  if (transaction.is_response_ok()) delay = delay_until(clock_, finish);
}

tlm::tlm_sync_enum MonoDdr::nb_transport_fw(tlm::tlm_generic_payload& transaction, tlm::tlm_phase& phase,
                                            sc_core::sc_time& delay) {
  return at_target_->nb_transport_fw(transaction, phase, delay);
}

std::optional<Cycles> MonoDdr::take(tlm::tlm_generic_payload& transaction) {
  const Cycles now = event_queue_->now();
  Cycles over = now;
  transaction.set_dmi_allowed(true);
  transaction.set_response_status(transaction.get_command() == tlm::TLM_IGNORE_COMMAND
                                      ? tlm::TLM_OK_RESPONSE
                                      : access_plainly(transaction, now, over));
  event_queue_->schedule(over, [this, &transaction] { finish(transaction); });
  if (++queued_ < queue_transactions_) return now;
  not_accepted_ = &transaction;
  return std::nullopt;
}

void MonoDdr::finish(tlm::tlm_generic_payload& transaction) {
  --queued_;
  if (not_accepted_ != nullptr && not_accepted_ != &transaction) at_target_->accept(*not_accepted_);
  not_accepted_ = nullptr;  // unless accepted, its response ends its request
  at_target_->respond(transaction);
}

tlm::tlm_response_status MonoDdr::access_plainly(const tlm::tlm_generic_payload& transaction, Cycles arrival,
                                                 Cycles& finish) {
  const tlm::tlm_response_status response = check_access(transaction, memory_.size_bytes());
  if (response != tlm::TLM_OK_RESPONSE) return response;
  const std::uint64_t bytes = transaction.get_data_length();
  if (faults_ != nullptr) faults_->accesses_ddr(transaction.get_address(), bytes, transaction.is_write());
  move_data(transaction, memory_.data(), bytes);
  finish = timing_.access(transaction.get_address(), bytes, transaction.is_write(), arrival).finish;
  return response;
}

tlm::tlm_response_status MonoDdr::serve(PeAddresses& addresses, sc_core::sc_time& delay) {
  const MonoPieces& pieces = addresses.pieces;
  addresses.served = true;
  addresses.first_data = delay;
  if (!pieces.within(memory_.size_bytes())) return tlm::TLM_ADDRESS_ERROR_RESPONSE;
  if (pieces.runs().empty()) return tlm::TLM_OK_RESPONSE;
  if (faults_ != nullptr)
    for (const MonoPieces::Run& run : pieces.runs())
      faults_->accesses_ddr(run.address, run.bytes, pieces.write());
  const Cycles arrival = cycle_of_delay(clock_, delay);
  const DdrTiming::Access access = timing_.access(pieces.runs(), pieces.write(), arrival);
  addresses.first_data = delay_until(clock_, access.start);
  delay = delay_until(clock_, access.finish);
  return tlm::TLM_OK_RESPONSE;
}

unsigned int MonoDdr::transport_dbg(tlm::tlm_generic_payload& transaction) {
  return move_for_debug(transaction, memory_.data(), memory_.size_bytes());
}

bool MonoDdr::get_direct_mem_ptr(tlm::tlm_generic_payload& transaction, tlm::tlm_dmi& dmi) {
  return give_pointer(transaction, dmi, memory_.data(), memory_.size_bytes(),
                      clock_.time_at(dmi_latency_cycles_));
}

}  // namespace model
