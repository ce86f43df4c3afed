#include "model/pio/lt_pio_service.hpp"

namespace model {
namespace {

std::size_t remembered_requests(int queue_depth) {
  std::size_t requests = 64;
  while (requests < 4 * (std::size_t(queue_depth) + 1)) requests *= 2;
  return requests;
}

}  // namespace

LtPioService::LtPioService(const ClockDomain& clock, int queue_depth, const PioTiming& timing,
                           PioRequests& requests, PioTransactions& transactions,
                           std::function<void(Cycles)> approach)
    : PioService(requests),
      clock_(clock),
      timing_(timing),
      transactions_(transactions),
      approach_(std::move(approach)),
      history_(std::size_t(requests.engines()), WordHistory(remembered_requests(queue_depth))) {}

bool LtPioService::serve_next() {
  if (requests_.waiting() == 0) return false;
  start(*requests_.next());
  return true;
}

std::optional<Cycles> LtPioService::next_start() const {
  if (requests_.waiting() == 0) return std::nullopt;
  return requests_.next()->cycle;
}

std::uint64_t LtPioService::words_moved_before(Cycles cycle) const {
  std::uint64_t words = 0;
  for (const WordHistory& history : history_) words += history.before(cycle);
  return words;
}

Cycles LtPioService::make_room() {
  const PioQueue::Start next = *requests_.next();
  start(next);
  return next.cycle;
}

void LtPioService::start(const PioQueue::Start& next) {
  approach_(next.cycle);
  PioRequest& request = requests_.request_of(next);
  const MonoPieces& pieces = request.addresses.pieces;
  const Cycles data_start = next.cycle + timing_.setup_cycles();
  transactions_.book_ports(request, data_start);
  const Cycles memory_start = timing_.memory_start(pieces, next.cycle);
  if (clock_.time_at(memory_start) < sc_core::sc_time_stamp()) ++requests_.statistics().late_starts;
  const Cycles memory_end = transactions_.book_memory(request, memory_start);
  const Cycles finish = timing_.finish(pieces, next.cycle, memory_end);
  history_[std::size_t(requests_.engine_of(next))].add(data_start, finish, pieces.mono_bytes() / 8);
  requests_.serve(next, finish);
}

}  // namespace model
