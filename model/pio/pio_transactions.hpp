#pragma once

#include <cstdint>
#include <string>
#include <systemc>
#include <tlm>
#include <vector>

#include "model/memory/mono_window.hpp"
#include "model/pio/pio_request.hpp"
#include "model/time/clock_domain.hpp"

namespace model {

/// What a fault says of a transaction that memory has answered with an error.
std::string refused_by_memory(const tlm::tlm_generic_payload& transaction);

/// The loosely timed transactions of a request, which book time and move no data: one with PeAddresses to
/// mono memory (or, if the memory does not know the extension, one read or write a run), and one to the
/// SRAMs' ports.
class PioTransactions {
 public:
  PioTransactions(const ClockDomain& clock, tlm::tlm_initiator_socket<>& mono_socket,
                  tlm::tlm_initiator_socket<>& poly_socket, MonoWindow& mono)
      : clock_(clock), mono_socket_(mono_socket), poly_socket_(poly_socket), mono_(mono) {}

  /// Returns when the memory side that begins at `start` is over. Throws cn::MachineFault when memory answers
  /// with an error.
  Cycles book_memory(PioRequest& request, Cycles start);
  /// Books the SRAMs' ports from `data_start` on.
  void book_ports(PioRequest& request, Cycles data_start);

 private:
  enum class Answer : std::uint8_t { not_asked, yes, no };

  bool memory_knows_addresses();
  sc_core::sc_time book_runs(const MonoPieces& pieces, const sc_core::sc_time& delay);
  void send_addresses(tlm::tlm_initiator_socket<>& socket, PeAddresses& addresses, std::uint64_t address,
                      sc_core::sc_time& delay);
  void prepare(tlm::tlm_command command, std::uint64_t address, std::uint64_t bytes);

  ClockDomain clock_;
  tlm::tlm_initiator_socket<>& mono_socket_;
  tlm::tlm_initiator_socket<>& poly_socket_;
  MonoWindow& mono_;
  Answer memory_knows_addresses_ = Answer::not_asked;
  tlm::tlm_generic_payload transaction_;
  std::vector<std::uint8_t> run_data_;
};

}  // namespace model
