// The PIO engine approximately timed: requests start, are served and end in SystemC time.

#include "firmware/cn/machine.hpp"
#include "model/pio/pio_engine.hpp"

namespace model {

void PioEngine::build_at(EventQueue& event_queue, const ChipConfig& config) {
  event_queue_ = &event_queue;
  mono_socket.register_nb_transport_bw(this, &PioEngine::nb_transport_bw);
  at_ = std::make_unique<AtPio>(
      event_queue, mono_socket, config, timing_, mono_,
      AtPio::Owner{[this](int engine) { finish_at(engine); }, [this](const auto& packet) { fail(packet); }});
}

tlm::tlm_sync_enum PioEngine::nb_transport_bw(tlm::tlm_generic_payload& packet, tlm::tlm_phase& phase,
                                              sc_core::sc_time& delay) {
  return at_->nb_transport_bw(packet, phase, delay);
}

void PioEngine::start_at(const PioQueue::Start& next) {
  Request& request = requests_[std::size_t(next.entry.slot)];
  const int engine = queue_.engine_of(next.entry.direction);
  in_service_[std::size_t(engine)] = &request;
  queue_.begin(next);
  note_start(request, next);
  at_->start(engine, request.addresses.pieces);
  progress_.notify(sc_core::SC_ZERO_TIME);
}

void PioEngine::finish_at(int engine) {
  Request& request = *in_service_[std::size_t(engine)];
  in_service_[std::size_t(engine)] = nullptr;
  const Cycles now = event_queue_->now();
  queue_.finish(engine, now);
  end_request(request, now);
  start_due(now);
  progress_.notify(sc_core::SC_ZERO_TIME);
}

/// The firmware is told: an exception cannot leave the event queue's process.
void PioEngine::fail(const tlm::tlm_generic_payload& packet) {
  failure_ = std::make_exception_ptr(cn::MachineFault(refused_by_memory(packet)));
}

void PioEngine::pass_time_until(Cycles cycle) {
  event_queue_->pass_time_until(cycle);
  if (failure_) std::rethrow_exception(failure_);
}

bool PioEngine::wait_for_request() {
  if (in_service_[0] == nullptr && in_service_[1] == nullptr) return false;
  wait_for_progress();
  return true;
}

void PioEngine::wait_for_progress() {
  event_queue_->pass_time_until(progress_);
  if (failure_) std::rethrow_exception(failure_);
}

}  // namespace model
