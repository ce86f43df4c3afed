#include "model/search_unit/search_unit.hpp"

#include <algorithm>

#include "firmware/cn/machine.hpp"
#include "model/config/address_map.hpp"
#include "model/memory/plain_access.hpp"
#include "model/time/annotated_delay.hpp"
#include "model/transaction/payload.hpp"

namespace model {

SearchUnit::SearchUnit(const sc_core::sc_module_name& name, const ChipConfig& config,
                       const ClockDomain& clock, EventQueue* event_queue)
    : sc_module(name),
      clock_(clock),
      bytes_per_cycle_(std::uint64_t(config.search_unit.bytes_per_cycle)),
      line_bytes_(std::uint64_t(config.search_unit.cache_line_bytes)),
      buffer_(search_unit_range(config)),
      timing_(config.search_unit,
              {[this](int unit, cn::MonoAddress first, Cycles at) { fetch(unit, first, at); },
               [this](int search, Cycles at) { take_answer(search - first_search_, at); }}),
      read_([this](cn::MonoAddress from, void* to, std::size_t bytes) { read_mono(from, to, bytes); }),
      line_data_(line_bytes_),
      event_queue_(event_queue) {
  traffic.bind(*this);
  socket.register_b_transport(this, &SearchUnit::b_transport);
  socket.register_transport_dbg(this, &SearchUnit::transport_dbg);
  socket.register_get_direct_mem_ptr(this, &SearchUnit::get_direct_mem_ptr);
  if (event_queue_ == nullptr) return;
  socket.register_nb_transport_fw(this, &SearchUnit::nb_transport_fw);
  mono_socket.register_nb_transport_bw(this, &SearchUnit::nb_transport_bw);
  at_target_.emplace(*event_queue_, AtTarget::Owner{[this](auto& transaction) { return take(transaction); },
                                                    [this](auto& transaction, auto& phase, auto& delay) {
                                                      return socket->nb_transport_bw(transaction, phase,
                                                                                     delay);
                                                    }});
  at_initiator_.emplace(*event_queue_, mono_socket,
                        AtInitiator::Owner{[](auto&) {}, [this](auto& packet) { return take_line(packet); }});
}

void SearchUnit::program(std::shared_ptr<cn::SearchFunction> function) {
  first_search_ += buffer_.entries();
  buffer_.program(std::move(function));
  searches_.assign(std::size_t(buffer_.entries()), 0);
  answered_.assign(std::size_t(buffer_.entries()), 0);
  timing_.forget_lines();
}

SearchStatistics SearchUnit::statistics() const {
  SearchStatistics all = timing_.statistics();
  all.bytes_written = statistics_.bytes_written;
  all.bytes_read = statistics_.bytes_read;
  all.answer_wait_cycles = statistics_.answer_wait_cycles;
  return all;
}

bool SearchUnit::accept(tlm::tlm_generic_payload& transaction) const {
  transaction.set_dmi_allowed(false);
  const bool is_access = transaction.get_command() != tlm::TLM_IGNORE_COMMAND;
  transaction.set_response_status(is_access ? check_access(transaction, buffer_.bytes())
                                            : tlm::TLM_OK_RESPONSE);
  return is_access && transaction.is_response_ok();
}

Cycles SearchUnit::move(tlm::tlm_generic_payload& transaction, Cycles ready) {
  const std::uint64_t bytes = transaction.get_data_length();
  port_free_ = std::max(ready, port_free_) + bytes_per_cycle_.quotient(bytes + bytes_per_cycle_.value() - 1);
  if (transaction.is_read()) {
    statistics_.bytes_read += bytes;
    buffer_.read(transaction.get_address(), transaction.get_data_ptr(), bytes, read_);
  } else {
    statistics_.bytes_written += bytes;
    buffer_.write(transaction.get_address(), transaction.get_data_ptr(), bytes);
  }
  return port_free_;
}

/// A query starts when its last byte is in the buffer.
Cycles SearchUnit::write(tlm::tlm_generic_payload& transaction, Cycles arrival) {
  const std::uint64_t address = transaction.get_address();
  const Cycles first = std::max(arrival, port_free_);
  const Cycles finish = move(transaction, arrival);
  const cn::SearchBuffer::Entries ended = buffer_.queries_ended_in(address, transaction.get_data_length());
  for (int entry = ended.first; entry < ended.last; ++entry) {
    const std::uint64_t bytes = buffer_.end_of_query(entry) - address;
    start(entry, first + bytes_per_cycle_.quotient(bytes + bytes_per_cycle_.value() - 1));
  }
  return finish;
}

void SearchUnit::start(int entry, Cycles at) {
  ++searches_[std::size_t(entry)];
  timing_.start(first_search_ + entry, buffer_.steps(entry, read_), at);
}

/// Searches that a program before has left under way have nobody to tell.
void SearchUnit::take_answer(int entry, Cycles at) {
  if (entry < 0) return;
  --searches_[std::size_t(entry)];
  answered_[std::size_t(entry)] = at;
}

bool SearchUnit::are_found(const cn::SearchBuffer::Entries& entries) const {
  return std::all_of(searches_.begin() + entries.first, searches_.begin() + entries.last,
                     [](int searches) { return searches == 0; });
}

Cycles SearchUnit::found_at(const cn::SearchBuffer::Entries& entries) const {
  Cycles latest = 0;
  for (int entry = entries.first; entry < entries.last; ++entry)
    latest = std::max(latest, answered_[std::size_t(entry)]);
  return latest;
}

void SearchUnit::b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay) {
  if (!accept(transaction)) return;
  const Cycles arrival = cycle_of_delay(clock_, delay);
  if (transaction.is_write()) {
    delay = delay_until(clock_, write(transaction, arrival));
    return;
  }
  const cn::SearchBuffer::Entries entries =
      buffer_.answers_in(transaction.get_address(), transaction.get_data_length());
  while (!are_found(entries)) timing_.step();
  const Cycles found = std::max(arrival, found_at(entries));
  statistics_.answer_wait_cycles += found - arrival;
  delay = delay_until(clock_, move(transaction, found));
}

void SearchUnit::book_until(Cycles cycle) {
  if (event_queue_ != nullptr || booking_) return;
  booking_ = true;  // lines pass the network, which asks again
  for (auto next = timing_.next(); next && *next <= cycle; next = timing_.next()) timing_.step();
  booking_ = false;
}

void SearchUnit::fetch(int unit, cn::MonoAddress first, Cycles at) {
  if (event_queue_ != nullptr)
    return event_queue_->schedule(at, [this, unit, first] { send_line(unit, first); });
  set_access(line_, tlm::TLM_READ_COMMAND, first, line_data_.data(), line_bytes_);
  sc_core::sc_time delay = delay_until(clock_, at);
  const bool outer = booking_;
  booking_ = true;
  mono_socket->b_transport(line_, delay);
  booking_ = outer;
  if (line_.is_response_error())
    throw cn::MachineFault("search unit: line of " + std::to_string(line_bytes_) + " bytes at " +
                           hexadecimal(first) + ": " + line_.get_response_string());
  timing_.arrived(unit, first, cycle_of_delay(clock_, delay));
}

void SearchUnit::read_mono(cn::MonoAddress from, void* to, std::size_t bytes) {
  tlm::tlm_generic_payload transaction;
  set_access(transaction, tlm::TLM_READ_COMMAND, from, static_cast<unsigned char*>(to), bytes);
  if (mono_socket->transport_dbg(transaction) != bytes)
    throw cn::MachineFault("search unit: " + std::to_string(bytes) + " bytes at " + hexadecimal(from) +
                           " are not in mono memory");
}

unsigned int SearchUnit::transport_dbg(tlm::tlm_generic_payload& transaction) {
  if (!accept(transaction)) return 0;
  const std::uint64_t bytes = transaction.get_data_length();
  if (transaction.is_read()) {
    buffer_.read(transaction.get_address(), transaction.get_data_ptr(), bytes, read_);
  } else {
    buffer_.write(transaction.get_address(), transaction.get_data_ptr(), bytes);
  }
  return static_cast<unsigned int>(bytes);
}

bool SearchUnit::get_direct_mem_ptr(tlm::tlm_generic_payload&, tlm::tlm_dmi& dmi) {
  dmi.init();  // refused for all addresses: answers are found when they are read
  return false;
}

tlm::tlm_sync_enum SearchUnit::nb_transport_fw(tlm::tlm_generic_payload& transaction, tlm::tlm_phase& phase,
                                               sc_core::sc_time& delay) {
  return at_target_->nb_transport_fw(transaction, phase, delay);
}

tlm::tlm_sync_enum SearchUnit::nb_transport_bw(tlm::tlm_generic_payload& transaction, tlm::tlm_phase& phase,
                                               sc_core::sc_time& delay) {
  return at_initiator_->nb_transport_bw(transaction, phase, delay);
}

Cycles SearchUnit::take(tlm::tlm_generic_payload& transaction) {
  const Cycles now = event_queue_->now();
  if (!accept(transaction)) {
    respond(transaction, now);
  } else if (transaction.is_write()) {
    respond(transaction, write(transaction, now));
    work_later();
  } else {
    readers_.push_back(
        {&transaction, buffer_.answers_in(transaction.get_address(), transaction.get_data_length()), now});
    work_later();
  }
  return now;
}

void SearchUnit::respond(tlm::tlm_generic_payload& transaction, Cycles at) {
  event_queue_->schedule(at, [this, &transaction] { at_target_->respond(transaction); });
}

/// Does what is due in this cycle, then serves the reads whose answers are there.
void SearchUnit::work() {
  const Cycles now = event_queue_->now();
  works_at_.reset();
  for (auto next = timing_.next(); next && *next <= now; next = timing_.next()) timing_.step();
  for (auto reader = readers_.begin(); reader != readers_.end();) {
    if (!are_found(reader->entries)) {
      ++reader;
      continue;
    }
    statistics_.answer_wait_cycles += now - reader->arrival;
    respond(*reader->transaction, move(*reader->transaction, now));
    reader = readers_.erase(reader);
  }
  work_later();
}

void SearchUnit::work_later() {
  const Cycles now = event_queue_->now();
  const bool serves = std::any_of(readers_.begin(), readers_.end(),
                                  [&](const Reader& reader) { return are_found(reader.entries); });
  const std::optional<Cycles> next = serves ? now : timing_.next();
  if (!next || (works_at_ && *works_at_ <= *next)) return;
  works_at_ = *next;
  event_queue_->schedule(*next, [this, at = *next] {
    if (works_at_ == at) work();
  });
}

void SearchUnit::send_line(int unit, cn::MonoAddress first) {
  tlm::tlm_generic_payload& packet = pool_.take(tlm::TLM_READ_COMMAND, first, line_bytes_);
  on_the_way_.push_back({&packet, first, unit});
  at_initiator_->send(packet);
}

Cycles SearchUnit::take_line(tlm::tlm_generic_payload& packet) {
  const auto way = std::find_if(on_the_way_.begin(), on_the_way_.end(),
                                [&](const OnTheWay& other) { return other.packet == &packet; });
  timing_.arrived(way->unit, way->first, event_queue_->now());
  on_the_way_.erase(way);
  packet.release();
  work_later();
  return event_queue_->now();
}

}  // namespace model
