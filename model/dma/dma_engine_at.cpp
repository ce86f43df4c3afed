// The PIO engine approximately timed: requests start, are served and end in SystemC time.

#include "firmware/cn/machine.hpp"
#include "model/dma/dma_engine.hpp"

namespace model {

void DmaEngine::build_at(Agenda& agenda, const ChipConfig& config) {
  agenda_ = &agenda;
  mono_socket.register_nb_transport_bw(this, &DmaEngine::nb_transport_bw);
  at_ = std::make_unique<AtPio>(
      agenda, mono_socket, config, timing_, mono_,
      AtPio::Owner{[this](int engine) { finish_at(engine); }, [this](const auto& packet) { fail(packet); }});
}

tlm::tlm_sync_enum DmaEngine::nb_transport_bw(tlm::tlm_generic_payload& packet, tlm::tlm_phase& phase,
                                              sc_core::sc_time& delay) {
  return at_->nb_transport_bw(packet, phase, delay);
}

void DmaEngine::start_at(const PioQueue::Start& next) {
  Request& request = requests_[std::size_t(next.entry.slot)];
  const int engine = queue_.engine_of(next.entry.direction);
  in_service_[std::size_t(engine)] = &request;
  queue_.begin(next);
  note_start(request, next);
  at_->start(engine, request.addresses.pieces);
  progress_.notify(sc_core::SC_ZERO_TIME);
}

void DmaEngine::finish_at(int engine) {
  Request& request = *in_service_[std::size_t(engine)];
  in_service_[std::size_t(engine)] = nullptr;
  const Cycles now = agenda_->now();
  queue_.finish(engine, now);
  end_request(request, now);
  start_due(now);
  progress_.notify(sc_core::SC_ZERO_TIME);
}

/// The firmware is told: an exception cannot leave the agenda's process.
void DmaEngine::fail(const tlm::tlm_generic_payload& packet) {
  failure_ = std::make_exception_ptr(cn::MachineFault(refused_by_memory(packet)));
}

void DmaEngine::pass_time_until(Cycles cycle) {
  agenda_->pass_time_until(cycle);
  if (failure_) std::rethrow_exception(failure_);
}

bool DmaEngine::wait_for_request() {
  if (in_service_[0] == nullptr && in_service_[1] == nullptr) return false;
  wait_for_progress();
  return true;
}

void DmaEngine::wait_for_progress() {
  agenda_->pass_time_until(progress_);
  if (failure_) std::rethrow_exception(failure_);
}

}  // namespace model
