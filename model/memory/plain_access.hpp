#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <tlm>

/// What the chip's memories do with a TLM-2.0 transaction besides timing it.
namespace model {

/// Whether a memory of so many bytes serves a read or write: no byte enables, no streaming.
inline tlm::tlm_response_status check_access(const tlm::tlm_generic_payload& transaction,
                                             std::uint64_t size_bytes) {
  const std::uint64_t address = transaction.get_address();
  const std::uint64_t bytes = transaction.get_data_length();
  if (address > size_bytes || bytes > size_bytes - address) return tlm::TLM_ADDRESS_ERROR_RESPONSE;
  if (transaction.get_byte_enable_ptr() != nullptr) return tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE;
  if (transaction.get_streaming_width() < bytes) return tlm::TLM_BURST_ERROR_RESPONSE;
  return tlm::TLM_OK_RESPONSE;
}

/// Moves the first `bytes` of a read or write. @param memory of all addresses, from 0
inline void move_data(const tlm::tlm_generic_payload& transaction, std::uint8_t* memory,
                      std::uint64_t bytes) {
  std::uint8_t* const storage = memory + transaction.get_address();
  if (transaction.is_write()) {
    std::memcpy(storage, transaction.get_data_ptr(), bytes);
  } else {
    std::memcpy(transaction.get_data_ptr(), storage, bytes);
  }
}

/// Debug transport: moves what lies within the memory. Returns how many bytes.
inline unsigned int move_for_debug(const tlm::tlm_generic_payload& transaction, std::uint8_t* memory,
                                   std::uint64_t size_bytes) {
  const std::uint64_t address = transaction.get_address();
  if (address >= size_bytes || transaction.get_command() == tlm::TLM_IGNORE_COMMAND) return 0;
  const auto bytes = std::min<std::uint64_t>(transaction.get_data_length(), size_bytes - address);
  move_data(transaction, memory, bytes);
  return static_cast<unsigned int>(bytes);
}

/// A direct pointer to the whole memory. Returns false if the transaction asks for another address.
inline bool give_pointer(const tlm::tlm_generic_payload& transaction, tlm::tlm_dmi& dmi, std::uint8_t* memory,
                         std::uint64_t size_bytes, const sc_core::sc_time& latency) {
  dmi.init();
  dmi.set_start_address(0);
  dmi.set_end_address(size_bytes - 1);
  if (transaction.get_address() >= size_bytes) return false;
  dmi.set_dmi_ptr(memory);
  dmi.set_read_latency(latency);
  dmi.set_write_latency(latency);
  dmi.allow_read_write();
  return true;
}

}  // namespace model
