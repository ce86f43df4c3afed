#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <tlm>
#include <vector>

#include "firmware/cn/chip/transfer.hpp"

namespace model {

/// Reads and writes mono memory's data without taking time: through a direct pointer if the memory behind the
/// socket grants one, else by debug transport, PE by PE.
class MonoWindow {
 public:
  MonoWindow(std::uint64_t size_bytes, cn::PolyMemory& poly);

  /// Both throw cn::MachineFault, which names `request` and the allowed range. `check_places` also names the
  /// first offending PE, so it is slower than MonoPieces::within: use it only to report.
  void check_span(const cn::Transfer& transfer, std::uint64_t request) const;
  void check_places(const cn::Transfer& transfer, std::uint64_t request) const;
  std::uint64_t size_bytes() const { return size_bytes_; }
  /// Moves the data of a transfer that was checked.
  void move(const cn::Transfer& transfer, tlm::tlm_fw_transport_if<>& memory);
  /// Copies the bytes that are at `address` now.
  void read(cn::MonoAddress address, std::uint8_t* to, std::uint64_t bytes,
            tlm::tlm_fw_transport_if<>& memory);
  /// Shows the bytes at `address`: in memory itself where it grants a pointer, else in a copy that lives as
  /// long as the window and is refreshed by the next view of the same address.
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
