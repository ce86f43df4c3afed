#pragma once

#include <cstdint>
#include <memory>
#include <tlm>
#include <vector>

#include "model/transaction/payload.hpp"

namespace model {

/// Generic payloads with room for their data, kept from one transaction to the next: once there are as many
/// as are on the way at a time, no further memory is allocated. Sticky extensions stay with a payload.
class PayloadPool : public tlm::tlm_mm_interface {
 public:
  PayloadPool() = default;
  PayloadPool(const PayloadPool&) = delete;
  PayloadPool& operator=(const PayloadPool&) = delete;

  /// A payload with one reference, which the caller releases.
  tlm::tlm_generic_payload& take(tlm::tlm_command command, std::uint64_t address, std::uint64_t bytes) {
    if (free_.empty()) create();
    Packet& packet = *free_.back();
    free_.pop_back();
    if (packet.data.size() < bytes) packet.data.resize(bytes);
    packet.acquire();
    set_access(packet, command, address, packet.data.data(), bytes);
    return packet;
  }

  /// Called by the payload when its last reference is released.
  void free(tlm::tlm_generic_payload* payload) override {
    payload->reset();
    free_.push_back(static_cast<Packet*>(payload));
  }

  std::size_t created() const { return packets_.size(); }
  std::size_t on_the_way() const { return packets_.size() - free_.size(); }

 private:
  struct Packet : tlm::tlm_generic_payload {
    explicit Packet(tlm::tlm_mm_interface* pool) : tlm_generic_payload(pool) {}
    std::vector<unsigned char> data;
  };

  void create() {
    packets_.push_back(std::make_unique<Packet>(this));
    free_.push_back(packets_.back().get());
  }

  std::vector<std::unique_ptr<Packet>> packets_;
  std::vector<Packet*> free_;
};

}  // namespace model
