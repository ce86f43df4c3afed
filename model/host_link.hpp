#pragma once

#include <tlm_utils/simple_initiator_socket.h>
#include <systemc>
#include <tlm>

#include "firmware/cn/mono_memory.hpp"
#include "model/chip_config.hpp"
#include "model/cycles.hpp"

namespace model {

struct HostLinkStatistics {
  std::uint64_t bytes_uploaded = 0;
  std::uint64_t bytes_downloaded = 0;
  std::uint64_t host_dmas = 0;
  std::uint64_t busy_cycles = 0;
};

/// PCI-X or PCIe between host memory and mono memory. A transfer is cut into host DMAs of at most 512 KiB
/// (ClearSpeed's driver); each takes latency_cycles and its bytes at bytes_per_second, one after the other.
/// Data move at once, by debug transport. Not booked on the chip's network: the link has a quarter of the DDR
/// port's width, and bookings that far ahead of the PIO engine's would delay requests that come before them.
class HostLink : public sc_core::sc_module {
 public:
  static constexpr std::uint64_t kMaxDmaBytes = 512 * 1024;

  tlm_utils::simple_initiator_socket<HostLink> socket{"socket"};

  HostLink(const sc_core::sc_module_name& name, const ChipConfig& config);

  /// Returns the cycle at which the last byte is there; the caller waits. Throws std::out_of_range when mono
  /// memory does not take all bytes.
  Cycles upload(cn::MonoAddress to, const void* from, std::uint64_t bytes, Cycles now);
  Cycles download(cn::MonoAddress from, void* to, std::uint64_t bytes, Cycles now);

  const HostLinkStatistics& statistics() const { return statistics_; }

 private:
  Cycles transfer(tlm::tlm_command command, cn::MonoAddress address, unsigned char* data, std::uint64_t bytes,
                  Cycles now);

  double clock_hz_;
  double bytes_per_second_;
  Cycles latency_cycles_;
  Cycles free_ = 0;
  HostLinkStatistics statistics_;
};

}  // namespace model
