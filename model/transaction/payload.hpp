#pragma once

#include <cstdint>
#include <tlm>

namespace model {

/// Makes `payload` a new access of `bytes` bytes at `address`, all of them enabled, whose answer is still to
/// come.
inline void set_access(tlm::tlm_generic_payload& payload, tlm::tlm_command command, std::uint64_t address,
                       unsigned char* data, std::uint64_t bytes) {
  payload.set_command(command);
  payload.set_address(address);
  payload.set_data_ptr(data);
  payload.set_data_length(static_cast<unsigned int>(bytes));
  payload.set_streaming_width(static_cast<unsigned int>(bytes));
  payload.set_byte_enable_ptr(nullptr);
  payload.set_dmi_allowed(false);
  payload.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
}

}  // namespace model
