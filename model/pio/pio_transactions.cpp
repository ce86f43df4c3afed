#include "model/pio/pio_transactions.hpp"

#include <algorithm>

#include "firmware/cn/machine.hpp"
#include "model/time/annotated_delay.hpp"
#include "model/transaction/payload.hpp"

namespace model {
namespace {

void check_response(const tlm::tlm_generic_payload& transaction) {
  if (!transaction.is_response_ok()) throw cn::MachineFault(refused_by_memory(transaction));
}

}  // namespace

std::string refused_by_memory(const tlm::tlm_generic_payload& transaction) {
  return "PIO transaction at mono address " + std::to_string(transaction.get_address()) +
         ": memory answered " + transaction.get_response_string();
}

Cycles PioTransactions::book_memory(PioRequest& request, Cycles start) {
  const MonoPieces& pieces = request.addresses.pieces;
  sc_core::sc_time delay = delay_until(clock_, start);
  if (memory_knows_addresses()) {
    send_addresses(mono_socket_, request.addresses, pieces.runs().front().address, delay);
    check_response(transaction_);
    if (request.addresses.served) return cycle_of_delay(clock_, delay);
  }
  return cycle_of_delay(clock_, book_runs(pieces, delay));
}

bool PioTransactions::memory_knows_addresses() {
  if (memory_knows_addresses_ == Answer::not_asked) {
    PeAddresses none;  // addresses of no PE book nothing
    sc_core::sc_time delay = sc_core::SC_ZERO_TIME;
    send_addresses(mono_socket_, none, 0, delay);
    memory_knows_addresses_ = none.served ? Answer::yes : Answer::no;
  }
  return memory_knows_addresses_ == Answer::yes;
}

sc_core::sc_time PioTransactions::book_runs(const MonoPieces& pieces, const sc_core::sc_time& delay) {
  sc_core::sc_time end = delay;
  for (const MonoPieces::Run& run : pieces.runs()) {
    prepare(pieces.write() ? tlm::TLM_WRITE_COMMAND : tlm::TLM_READ_COMMAND, run.address, run.bytes);
    // The data moved when the request was queued. A write repeats what the memory holds by now, so a later
    // writer's data survive.
    if (pieces.write()) mono_.read(run.address, run_data_.data(), run.bytes, *mono_socket_.operator->());
    sc_core::sc_time run_delay = delay;
    mono_socket_->b_transport(transaction_, run_delay);
    check_response(transaction_);
    end = std::max(end, run_delay);
  }
  return end;
}

void PioTransactions::book_ports(PioRequest& request, Cycles data_start) {
  sc_core::sc_time delay = delay_until(clock_, data_start);
  send_addresses(poly_socket_, request.addresses, std::uint64_t(request.poly.offset_bytes), delay);
}

void PioTransactions::send_addresses(tlm::tlm_initiator_socket<>& socket, PeAddresses& addresses,
                                     std::uint64_t address, sc_core::sc_time& delay) {
  addresses.served = false;
  prepare(tlm::TLM_IGNORE_COMMAND, address, 8);
  transaction_.set_extension(&addresses);
  socket->b_transport(transaction_, delay);
  transaction_.clear_extension(&addresses);
}

void PioTransactions::prepare(tlm::tlm_command command, std::uint64_t address, std::uint64_t bytes) {
  if (run_data_.size() < bytes) run_data_.resize(bytes);
  set_access(transaction_, command, address, run_data_.data(), bytes);
}

}  // namespace model
