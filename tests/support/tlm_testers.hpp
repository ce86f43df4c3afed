#pragma once

#include <tlm_utils/simple_initiator_socket.h>
#include <tlm_utils/simple_target_socket.h>
#include <cstring>
#include <map>
#include <systemc>
#include <tlm>
#include <vector>

#include "model/pio/pio_port.hpp"

namespace test_support {

/// An initiator that sends single transactions and keeps their responses.
class TestInitiator : public sc_core::sc_module {
 public:
  tlm_utils::simple_initiator_socket<TestInitiator> socket{"socket"};

  explicit TestInitiator(const sc_core::sc_module_name& name) : sc_module(name) {
    socket.register_invalidate_direct_mem_ptr(this, &TestInitiator::invalidated);
  }

  tlm::tlm_generic_payload transaction;
  tlm::tlm_dmi dmi;
  int invalidations = 0;

  /// Returns the delay after the call; `transaction` holds the response.
  sc_core::sc_time send(tlm::tlm_command command, std::uint64_t address, void* data, std::size_t bytes,
                        sc_core::sc_time delay) {
    prepare(command, address, data, bytes);
    socket->b_transport(transaction, delay);
    return delay;
  }
  unsigned int debug(tlm::tlm_command command, std::uint64_t address, void* data, std::size_t bytes) {
    prepare(command, address, data, bytes);
    return socket->transport_dbg(transaction);
  }
  bool ask_for_pointer(std::uint64_t address) {
    prepare(tlm::TLM_READ_COMMAND, address, nullptr, 0);
    return socket->get_direct_mem_ptr(transaction, dmi);
  }

 private:
  void prepare(tlm::tlm_command command, std::uint64_t address, void* data, std::size_t bytes) {
    transaction.set_command(command);
    transaction.set_address(address);
    transaction.set_data_ptr(static_cast<unsigned char*>(data));
    transaction.set_data_length(static_cast<unsigned int>(bytes));
    transaction.set_streaming_width(static_cast<unsigned int>(bytes));
    transaction.set_byte_enable_ptr(nullptr);
    transaction.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
  }
  void invalidated(sc_dt::uint64, sc_dt::uint64) { ++invalidations; }
};

/// A minimal TLM-2.0 memory: a fixed latency, debug transport, no DMI, no extensions.
class MinimalMemory : public sc_core::sc_module {
 public:
  tlm_utils::simple_target_socket<MinimalMemory> socket{"socket"};

  MinimalMemory(const sc_core::sc_module_name& name, std::size_t size_bytes, const sc_core::sc_time& latency)
      : sc_module(name), bytes(size_bytes), latency_(latency) {
    socket.register_b_transport(this, &MinimalMemory::b_transport);
    socket.register_transport_dbg(this, &MinimalMemory::transport_dbg);
  }

  std::vector<unsigned char> bytes;
  std::map<std::uint64_t, sc_core::sc_time> extra_latency;  ///< added to the latency, by address
  int reads = 0;
  int writes = 0;

 private:
  void b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay) {
    reads += transaction.is_read();
    writes += transaction.is_write();
    delay += latency_;
    const auto extra = extra_latency.find(transaction.get_address());
    if (extra != extra_latency.end()) delay += extra->second;
    const bool ignored = !transaction.is_read() && !transaction.is_write();
    const bool moved = ignored || transport_dbg(transaction) == transaction.get_data_length();
    transaction.set_response_status(moved ? tlm::TLM_OK_RESPONSE : tlm::TLM_ADDRESS_ERROR_RESPONSE);
  }
  unsigned int transport_dbg(tlm::tlm_generic_payload& transaction) {
    const std::size_t address = transaction.get_address();
    const unsigned int length = transaction.get_data_length();
    if (address + length > bytes.size()) return 0;
    if (transaction.is_read()) std::memcpy(transaction.get_data_ptr(), &bytes[address], length);
    if (transaction.is_write()) std::memcpy(&bytes[address], transaction.get_data_ptr(), length);
    return length;
  }

  sc_core::sc_time latency_;
};

/// Records which semaphores were signalled when.
class SignalRecorder : public sc_core::sc_module, public model::SemaphorePort {
 public:
  explicit SignalRecorder(const sc_core::sc_module_name& name) : sc_module(name) {}

  void signal_at(int index, model::Cycles at) override { signals[index].push_back(at); }

  std::map<int, std::vector<model::Cycles>> signals;
};

}  // namespace test_support
