#include "model/pio/at_pio_service.hpp"

#include "firmware/cn/machine.hpp"

namespace model {

AtPioService::AtPioService(EventQueue& event_queue, tlm::tlm_initiator_socket<>& memory,
                           const ChipConfig& config, const PioTiming& timing, MonoWindow& mono,
                           PioRequests& requests, PioTransactions& transactions)
    : PioService(requests),
      event_queue_(event_queue),
      timing_(timing),
      transactions_(transactions),
      packets_(event_queue, memory, config, timing, mono,
               {[this](int engine) { finish(engine); }, [this](const auto& packet) { fail(packet); }}) {}

void AtPioService::settle(Cycles now) {
  event_queue_.pass_time_until(now);
  if (failure_) std::rethrow_exception(failure_);
}

bool AtPioService::serve_next() {
  if (in_service_[0] == nullptr && in_service_[1] == nullptr) return false;
  wait_for_progress();
  return true;
}

Cycles AtPioService::make_room() {
  wait_for_progress();
  return event_queue_.now();
}

void AtPioService::wait_for_progress() {
  event_queue_.pass_time_until(progress_);
  if (failure_) std::rethrow_exception(failure_);
}

void AtPioService::start(const PioQueue::Start& next) {
  PioRequest& request = requests_.request_of(next);
  const int engine = requests_.engine_of(next);
  transactions_.book_ports(request, next.cycle + timing_.setup_cycles());
  in_service_[std::size_t(engine)] = &request;
  requests_.begin(next);
  packets_.start(engine, request.addresses.pieces);
  progress_.notify(sc_core::SC_ZERO_TIME);
}

void AtPioService::finish(int engine) {
  PioRequest& request = *in_service_[std::size_t(engine)];
  in_service_[std::size_t(engine)] = nullptr;
  const Cycles now = event_queue_.now();
  requests_.end(request, engine, now);
  start_due(now);
  progress_.notify(sc_core::SC_ZERO_TIME);
}

/// Keeps the fault for the firmware's process: an exception cannot leave the event queue's.
void AtPioService::fail(const tlm::tlm_generic_payload& packet) {
  failure_ = std::make_exception_ptr(cn::MachineFault(refused_by_memory(packet)));
}

}  // namespace model
