#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <tlm>
#include <vector>

#include "firmware/cn/chip/transfer.hpp"

namespace model {

/// The data of mono memory as the PIO engine reaches them: by a direct pointer if the memory behind the
/// socket grants one, else by debug transport, PE by PE. Takes no time.
class MonoWindow {
 public:
  MonoWindow(std::uint64_t size_bytes, cn::PolyMemory& poly);

  /// These throw cn::MachineFault naming `request` and the allowed range; of places the first PE's that is
  /// outside, too, which takes longer than to know that none is (MonoPieces::within).
  void check_span(const cn::Transfer& transfer, std::uint64_t request) const;
  void check_places(const cn::Transfer& transfer, std::uint64_t request) const;
  std::uint64_t size_bytes() const { return size_bytes_; }
  /// Of a transfer that was checked.
  void move(const cn::Transfer& transfer, tlm::tlm_fw_transport_if<>& memory);
  /// The bytes that are at `address` now.
  void read(cn::MonoAddress address, std::uint8_t* to, std::uint64_t bytes,
            tlm::tlm_fw_transport_if<>& memory);
  /// The bytes at `address` to look at: memory's own where it grants a pointer, else a copy that is made now
  /// and lives as long as the window; asking again for the same address refreshes it.
  const void* view(cn::MonoAddress address, std::uint64_t bytes, tlm::tlm_fw_transport_if<>& memory);
  void write(cn::MonoAddress address, const void* from, std::uint64_t bytes,
             tlm::tlm_fw_transport_if<>& memory);
  void invalidate() { pointer_ = Pointer::not_asked; }

 private:
  enum class Pointer : std::uint8_t { not_asked, granted, refused };

  void check_range(cn::MonoAddress address, std::uint64_t bytes) const;
  bool has_pointer(tlm::tlm_fw_transport_if<>& memory);
  void move_by_debug(const cn::Transfer& transfer, tlm::tlm_fw_transport_if<>& memory);
  void debug(tlm::tlm_command command, cn::MonoAddress address, std::uint8_t* data, std::uint64_t bytes,
             tlm::tlm_fw_transport_if<>& memory);

  std::uint64_t size_bytes_;
  cn::PolyMemory& poly_;
  Pointer pointer_ = Pointer::not_asked;
  std::uint8_t* mono_ = nullptr;  ///< storage of mono address 0
  std::vector<std::uint8_t> piece_;
  std::map<cn::MonoAddress, std::vector<std::uint8_t>> copies_;
};

}  // namespace model
