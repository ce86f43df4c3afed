#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tlm>

#include "firmware/cn/chip/mono_memory.hpp"
#include "model/config/chip_config.hpp"
#include "model/time/cycles.hpp"

namespace model {

/// How long transfers take on the host link. A transfer is cut into DMAs of the host of at most 512 KiB
/// (ClearSpeed's driver); each takes latency_cycles and its bytes at bytes_per_second, one after the other.
struct HostLinkTiming {
  static constexpr std::uint64_t kMaxDmaBytes = 512 * 1024;

  explicit HostLinkTiming(const ChipConfig& config)
      : clock_hz(config.chip.clock_hz),
        bytes_per_second(config.host.bytes_per_second),
        latency_cycles(Cycles(config.host.latency_cycles)),
        packet_bytes(std::uint64_t(config.clear_connect.packet_bytes)) {}

  Cycles data_cycles(std::uint64_t bytes) const {
    return Cycles(std::ceil(double(bytes) * clock_hz / bytes_per_second));
  }
  /// From now on the bytes cross so many bridges of the board behind the link: each adds its latency to every
  /// DMA, and the narrowest part sets the pace.
  void cross_bridges(int bridges, const ChipConfig::Board& board) {
    if (bridges == 0) return;
    bytes_per_second = std::min(bytes_per_second, board.bridge_bytes_per_cycle * board.bridge_clock_hz);
    latency_cycles +=
        Cycles(std::ceil(double(bridges) * board.bridge_latency_cycles * clock_hz / board.bridge_clock_hz));
  }

  Cycles dma_cycles(std::uint64_t bytes) const { return latency_cycles + data_cycles(bytes); }

  double clock_hz;
  double bytes_per_second;
  Cycles latency_cycles;
  std::uint64_t packet_bytes;
};

/// The packets of one transfer on the chip's network, in order. Uploaded bytes are sent on when they have
/// crossed the link; bytes to download are fetched a DMA's latency before they cross it.
class HostPackets {
 public:
  HostPackets(const HostLinkTiming& timing, tlm::tlm_command command, cn::MonoAddress address,
              std::uint64_t bytes, Cycles start)
      : timing_(&timing), command_(command), address_(address), bytes_(bytes), dma_start_(start) {}

  bool at_end() const { return done_ == bytes_; }
  tlm::tlm_command command() const { return command_; }
  cn::MonoAddress address() const { return address_ + done_; }
  std::uint64_t bytes() const { return std::min(timing_->packet_bytes, dma_end() - done_); }
  Cycles due() const {
    const std::uint64_t in_dma = done_ % HostLinkTiming::kMaxDmaBytes;
    return command_ == tlm::TLM_WRITE_COMMAND
               ? dma_start_ + timing_->latency_cycles + timing_->data_cycles(in_dma + bytes())
               : dma_start_ + timing_->data_cycles(in_dma);
  }
  void advance() {
    const std::uint64_t end = dma_end();
    done_ += bytes();
    if (done_ == end) dma_start_ += timing_->dma_cycles((end - 1) % HostLinkTiming::kMaxDmaBytes + 1);
  }

 private:
  std::uint64_t dma_end() const {
    constexpr std::uint64_t kDma = HostLinkTiming::kMaxDmaBytes;
    return std::min(bytes_, (done_ / kDma + 1) * kDma);
  }

  const HostLinkTiming* timing_;
  tlm::tlm_command command_;
  cn::MonoAddress address_;
  std::uint64_t bytes_;
  Cycles dma_start_;
  std::uint64_t done_ = 0;
};

}  // namespace model
