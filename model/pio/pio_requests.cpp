#include "model/pio/pio_requests.hpp"

#include <algorithm>

namespace model {

PioRequests::PioRequests(const ChipConfig::Pio& config, const PioTiming& timing, Signal signal)
    : timing_(timing),
      signal_(std::move(signal)),
      queue_(config.arbitration, config.queue_depth),
      requests_(std::size_t((config.queue_depth + 1) * queue_.engines())) {
  for (std::size_t slot = 0; slot < requests_.size(); ++slot) free_slots_.push_back(static_cast<int>(slot));
}

void PioRequests::push(PioRequest& request, const cn::Transfer& transfer, Cycles accepted) {
  request.id = next_id_++;
  request.poly = transfer.poly;
  request.done = transfer.done;
  request.label = transfer.label;
  if (observer_ != nullptr) request.enabled = transfer.enabled;
  queue_.push({request.id, transfer.direction, accepted, free_slots_.back()});
  free_slots_.pop_back();
}

void PioRequests::serve(const PioQueue::Start& start, Cycles finish) {
  PioRequest& request = request_of(start);
  queue_.begin(start, finish);
  record_start(request, start);
  record_end(request, finish);
}

void PioRequests::begin(const PioQueue::Start& start) {
  queue_.begin(start);
  record_start(request_of(start), start);
}

void PioRequests::end(PioRequest& request, int engine, Cycles finish) {
  queue_.finish(engine, finish);
  record_end(request, finish);
}

void PioRequests::skip(const cn::Transfer& transfer, Cycles now) {
  ++statistics_.empty_requests;
  signal(transfer.done, now);
}

void PioRequests::record_start(PioRequest& request, const PioQueue::Start& start) {
  const MonoPieces& pieces = request.addresses.pieces;
  request.event = {
      request.id, pieces.direction(), pieces.poly_bytes(), pieces.pes(), start.entry.enqueued, start.cycle,
      0,          request.done.index, queue_.waiting()};
  if (observer_ == nullptr) return;
  request.event.label = request.label;
  request.event.enabled = &request.enabled;
  observer_->started(request.event);
}

void PioRequests::record_end(PioRequest& request, Cycles finish) {
  request.event.finished = finish;
  count(request.event, timing_.pe_cycles(request.addresses.pieces));
  if (observer_ != nullptr) observer_->finished(request.event);
  free_slots_.push_back(static_cast<int>(&request - requests_.data()));
  signal(request.done, finish);
}

void PioRequests::count(const PioEvent& event, Cycles pe_cycles) {
  const bool to_poly = event.direction == cn::Direction::mono_to_poly;
  ++(to_poly ? statistics_.requests_to_poly : statistics_.requests_to_mono);
  (to_poly ? statistics_.bytes_to_poly : statistics_.bytes_to_mono) += event.bytes;
  statistics_.pes += std::uint64_t(event.pes);
  statistics_.setup_cycles += timing_.setup_cycles();
  statistics_.pe_cycles += pe_cycles;
  statistics_.memory_wait_cycles += event.finished - event.started - timing_.setup_cycles() - pe_cycles;
  statistics_.queue_wait_cycles += event.started - event.enqueued;
}

void PioRequests::signal(cn::Semaphore done, Cycles at) {
  if (done.index >= 0) signal_(done.index, at);
}

}  // namespace model
