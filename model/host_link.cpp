#include "model/host_link.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace model {

HostLink::HostLink(const sc_core::sc_module_name& name, const ChipConfig& config)
    : sc_module(name),
      clock_hz_(config.chip.clock_hz),
      bytes_per_second_(config.host.bytes_per_second),
      latency_cycles_(Cycles(config.host.latency_cycles)) {}

Cycles HostLink::upload(cn::MonoAddress to, const void* from, std::uint64_t bytes, Cycles now) {
  statistics_.bytes_uploaded += bytes;
  // The generic payload has one pointer for both directions; a write command does not change what it points
  // at.
  auto* const data = static_cast<unsigned char*>(const_cast<void*>(from));
  return transfer(tlm::TLM_WRITE_COMMAND, to, data, bytes, now);
}

Cycles HostLink::download(cn::MonoAddress from, void* to, std::uint64_t bytes, Cycles now) {
  statistics_.bytes_downloaded += bytes;
  return transfer(tlm::TLM_READ_COMMAND, from, static_cast<unsigned char*>(to), bytes, now);
}

Cycles HostLink::transfer(tlm::tlm_command command, cn::MonoAddress address, unsigned char* data,
                          std::uint64_t bytes, Cycles now) {
  const Cycles start = std::max(now, free_);
  Cycles end = start;
  for (std::uint64_t done = 0; done < bytes;) {
    const std::uint64_t dma_bytes = std::min(bytes - done, kMaxDmaBytes);
    tlm::tlm_generic_payload transaction;
    transaction.set_command(command);
    transaction.set_address(address + done);
    transaction.set_data_ptr(data + done);
    transaction.set_data_length(static_cast<unsigned int>(dma_bytes));
    transaction.set_streaming_width(static_cast<unsigned int>(dma_bytes));
    if (socket->transport_dbg(transaction) != dma_bytes)
      throw std::out_of_range("host link: " + std::to_string(bytes) + " bytes at mono address " +
                              std::to_string(address) + " do not fit mono memory");
    end += latency_cycles_ + Cycles(std::ceil(double(dma_bytes) * clock_hz_ / bytes_per_second_));
    ++statistics_.host_dmas;
    done += dma_bytes;
  }
  statistics_.busy_cycles += end - start;
  return free_ = end;
}

}  // namespace model
