#include "model/pio/pio_engine.hpp"

#include <algorithm>

#include "firmware/cn/machine.hpp"
#include "model/time/annotated_delay.hpp"
#include "model/transaction/payload.hpp"

namespace model {
namespace {

std::size_t remembered_requests(int queue_depth) {
  std::size_t requests = 64;
  while (requests < 4 * (std::size_t(queue_depth) + 1)) requests *= 2;
  return requests;
}

bool any_enabled(const cn::LaneMask& enabled, int num_pes) {
  for (int strip = 0; strip * cn::kStripLanes < num_pes; ++strip)
    if (enabled.strip_bits(strip) != 0) return true;
  return false;
}

void check_response(const tlm::tlm_generic_payload& transaction) {
  if (!transaction.is_response_ok()) throw cn::MachineFault(refused_by_memory(transaction));
}

}  // namespace

std::string refused_by_memory(const tlm::tlm_generic_payload& transaction) {
  return "PIO transaction at mono address " + std::to_string(transaction.get_address()) +
         ": memory answered " + transaction.get_response_string();
}

PioEngine::PioEngine(const sc_core::sc_module_name& name, const ChipConfig& config, const ClockDomain& clock,
                     cn::PolyMemory& poly, EventQueue* event_queue)
    : sc_module(name),
      clock_(clock),
      poly_(poly),
      rules_{Divisor(std::uint64_t(config.clear_connect.packet_bytes)),
             config.pio.consolidate_equal_addresses},
      timing_(config.pio),
      queue_(config.pio.arbitration, config.pio.queue_depth),
      mono_(config.ddr.size_bytes, poly),
      requests_(std::size_t((config.pio.queue_depth + 1) * queue_.engines())),
      history_(std::size_t(queue_.engines()), WordHistory(remembered_requests(config.pio.queue_depth))) {
  port.bind(*this);
  mono_socket.register_invalidate_direct_mem_ptr(this, &PioEngine::forget_mono_pointer);
  for (std::size_t slot = 0; slot < requests_.size(); ++slot) free_slots_.push_back(static_cast<int>(slot));
  if (event_queue != nullptr) build_at(*event_queue, config);
}

void PioEngine::forget_mono_pointer(sc_dt::uint64, sc_dt::uint64) {
  mono_.invalidate();
}

Cycles PioEngine::enqueue(const cn::Transfer& transfer, Cycles now) {
  settle(now);
  if (transfer.poly.size_bytes == 0 || !any_enabled(transfer.enabled, poly_.num_pes())) {
    ++statistics_.empty_requests;
    signal(transfer.done, now);
    return now;
  }
  mono_.check_span(transfer, next_id_);
  Cycles accepted = now;
  while (queue_.full(transfer.direction)) accepted = std::max(accepted, make_room());
  statistics_.blocked_cycles += accepted - now;

  const int slot = free_slots_.back();
  Request& request = requests_[std::size_t(slot)];
  request.addresses.pieces.describe(transfer, poly_.num_pes(), rules_);
  if (!request.addresses.pieces.within(mono_.size_bytes())) mono_.check_places(transfer, next_id_);
  free_slots_.pop_back();
  request.id = next_id_++;
  request.poly = transfer.poly;
  request.done = transfer.done;
  request.label = transfer.label;
  if (observer_ != nullptr) request.enabled = transfer.enabled;
  cn::Transfer of_copied_addresses = transfer;  // a scatter may overwrite a table of addresses
  of_copied_addresses.mono = request.addresses.pieces.places();
  if (!leaves_data_) mono_.move(of_copied_addresses, *mono_socket.operator->());
  if (at_) at_->refresh_writes_on_the_way();
  queue_.push({request.id, transfer.direction, accepted, slot});
  start_due(accepted);
  statistics_.max_queue_depth = std::max(statistics_.max_queue_depth, queue_.waiting());
  return accepted;
}

Cycles PioEngine::make_room() {
  if (at_) {
    wait_for_progress();
    return event_queue_->now();
  }
  const PioQueue::Start next = *queue_.next();
  start(next);
  return next.cycle;
}

void PioEngine::settle(Cycles now) {
  if (at_) return pass_time_until(now);
  start_due(now);
}

void PioEngine::start_due(Cycles now) {
  if (!queue_.may_start(now)) return;
  for (auto next = queue_.next(); next && next->cycle <= now; next = queue_.next()) start(*next);
}

bool PioEngine::serve_next() {
  if (at_) return wait_for_request();
  if (queue_.waiting() == 0) return false;
  start(*queue_.next());
  return true;
}

std::optional<Cycles> PioEngine::next_start() const {
  if (at_) return std::nullopt;  // it starts by itself
  if (queue_.waiting() == 0) return std::nullopt;
  return queue_.next()->cycle;
}

std::uint64_t PioEngine::words_moved_before(Cycles cycle) const {
  if (at_) return at_->words_moved();
  std::uint64_t words = 0;
  for (const WordHistory& history : history_) words += history.before(cycle);
  return words;
}

void PioEngine::start(const PioQueue::Start& next) {
  Request& request = requests_[std::size_t(next.entry.slot)];
  const MonoPieces& pieces = request.addresses.pieces;
  const Cycles data_start = next.cycle + timing_.setup_cycles();
  book_poly(request, data_start);
  if (at_) return start_at(next);
  const Cycles memory_end = book_memory(request, timing_.memory_start(pieces, next.cycle));
  const Cycles finish = timing_.finish(pieces, next.cycle, memory_end);
  queue_.begin(next, finish);
  history_[std::size_t(queue_.engine_of(next.entry.direction))].add(data_start, finish,
                                                                    pieces.mono_bytes() / 8);
  note_start(request, next);
  end_request(request, finish);
}

void PioEngine::note_start(Request& request, const PioQueue::Start& next) {
  const MonoPieces& pieces = request.addresses.pieces;
  request.event = {
      request.id, pieces.direction(), pieces.poly_bytes(), pieces.pes(), next.entry.enqueued, next.cycle,
      0,          request.done.index, queue_.waiting()};
  if (observer_ == nullptr) return;
  request.event.label = request.label;
  request.event.enabled = &request.enabled;
  observer_->started(request.event);
}

void PioEngine::end_request(Request& request, Cycles finish) {
  request.event.finished = finish;
  count(request.event, timing_.pe_cycles(request.addresses.pieces));
  if (observer_ != nullptr) observer_->finished(request.event);
  free_slots_.push_back(static_cast<int>(&request - requests_.data()));
  signal(request.done, finish);
}

void PioEngine::signal(cn::Semaphore done, Cycles at) {
  if (done.index >= 0) semaphores->signal_at(done.index, at);
}

Cycles PioEngine::book_memory(Request& request, Cycles start) {
  if (clock_.time_at(start) < sc_core::sc_time_stamp()) ++statistics_.late_starts;
  sc_core::sc_time delay = delay_until(clock_, start);
  if (!ask_memory()) return cycle_of_delay(clock_, book_runs(request.addresses.pieces, delay));
  send_addresses(mono_socket, request.addresses, request.addresses.pieces.runs().front().address, delay);
  check_response(transaction_);
  return cycle_of_delay(clock_, delay);
}

bool PioEngine::ask_memory() {
  if (memory_serves_ == Answer::not_asked) {
    PeAddresses none;  // of no PE: nothing is booked on the way
    sc_core::sc_time delay = sc_core::SC_ZERO_TIME;
    send_addresses(mono_socket, none, 0, delay);
    memory_serves_ = none.served ? Answer::yes : Answer::no;
  }
  return memory_serves_ == Answer::yes;
}

void PioEngine::send_addresses(tlm_utils::simple_initiator_socket<PioEngine>& socket, PeAddresses& addresses,
                               std::uint64_t address, sc_core::sc_time& delay) {
  addresses.served = false;
  prepare(tlm::TLM_IGNORE_COMMAND, address, 8);
  transaction_.set_extension(&addresses);
  socket->b_transport(transaction_, delay);
  transaction_.clear_extension(&addresses);
}

sc_core::sc_time PioEngine::book_runs(const MonoPieces& pieces, const sc_core::sc_time& delay) {
  sc_core::sc_time end = delay;
  for (const MonoPieces::Run& run : pieces.runs()) {
    prepare(pieces.write() ? tlm::TLM_WRITE_COMMAND : tlm::TLM_READ_COMMAND, run.address, run.bytes);
    // The data moved when the request was queued. A write repeats what the memory holds by now, so a later
    // writer's data survive.
    if (pieces.write()) mono_.read(run.address, run_data_.data(), run.bytes, *mono_socket.operator->());
    sc_core::sc_time run_delay = delay;
    mono_socket->b_transport(transaction_, run_delay);
    check_response(transaction_);
    end = std::max(end, run_delay);
  }
  return end;
}

void PioEngine::book_poly(Request& request, Cycles data_start) {
  sc_core::sc_time delay = delay_until(clock_, data_start);
  send_addresses(poly_socket, request.addresses, std::uint64_t(request.poly.offset_bytes), delay);
}

void PioEngine::prepare(tlm::tlm_command command, std::uint64_t address, std::uint64_t bytes) {
  if (run_data_.size() < bytes) run_data_.resize(bytes);
  set_access(transaction_, command, address, run_data_.data(), bytes);
}

void PioEngine::count(const PioEvent& event, Cycles pe_cycles) {
  const bool to_poly = event.direction == cn::Direction::mono_to_poly;
  ++(to_poly ? statistics_.requests_to_poly : statistics_.requests_to_mono);
  (to_poly ? statistics_.bytes_to_poly : statistics_.bytes_to_mono) += event.bytes;
  statistics_.pes += std::uint64_t(event.pes);
  statistics_.setup_cycles += timing_.setup_cycles();
  statistics_.pe_cycles += pe_cycles;
  statistics_.memory_wait_cycles += event.finished - event.started - timing_.setup_cycles() - pe_cycles;
  statistics_.queue_wait_cycles += event.started - event.enqueued;
}

}  // namespace model
