#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <tlm>
#include <vector>

#include "firmware/cn/chip/transfer.hpp"
#include "model/config/address_map.hpp"
#include "model/transaction/mono_pieces.hpp"

namespace model {

/// Reads and writes mono memory's data without taking time: through a direct pointer if the memory that the
/// socket reaches at those addresses grants one, else by debug transport, PE by PE.
class MonoWindow {
 public:
  MonoWindow(AddressMap map, cn::PolyMemory& poly)
      : own_map_(std::move(map)),
        poly_(poly),
        piece_(std::size_t(poly.capacity_bytes() + cn::PolyMemory::kReservedBytes)) {}
  MonoWindow(const MonoWindow&) = delete;
  MonoWindow& operator=(const MonoWindow&) = delete;

  /// From now on the ranges are those of `map`, which lives as long as the window and may grow.
  void follow(const AddressMap& map) { map_ = &map; }

  /// All throw cn::MachineFault, which names `request` and what is allowed. `check_places` also names the
  /// first offending PE, so it is slower than range_of(): use it only to report.
  void check_span(const cn::Transfer& transfer, std::uint64_t request) const;
  void check_places(const cn::Transfer& transfer, std::uint64_t request) const;
  void check_runs(const cn::Transfer& transfer, const MonoPieces& pieces, std::uint64_t request) const;

  /// The range of the map that holds all pieces, or AddressMap::kNowhere: they lie in several, or outside.
  int range_of(const MonoPieces& pieces) const;
  int range_of(const cn::Transfer& transfer) const;
  /// Moves the data of a transfer that was checked. @param range what range_of() says
  void move(const cn::Transfer& transfer, int range, tlm::tlm_fw_transport_if<>& memory);
  /// Copies the bytes that are at `address` now.
  void read(cn::MonoAddress address, std::uint8_t* to, std::uint64_t bytes,
            tlm::tlm_fw_transport_if<>& memory);
  /// Shows the bytes at `address`: in memory itself where it grants a pointer, else in a copy that lives as
  /// long as the window and is refreshed by the next view of the same address.
  const void* view(cn::MonoAddress address, std::uint64_t bytes, tlm::tlm_fw_transport_if<>& memory);
  void write(cn::MonoAddress address, const void* from, std::uint64_t bytes,
             tlm::tlm_fw_transport_if<>& memory);
  void invalidate() { pointers_.clear(); }

 private:
  enum class Answer : std::uint8_t { not_asked, granted, refused };
  struct Pointer {
    Answer answer = Answer::not_asked;
    std::uint8_t* first = nullptr;  ///< storage of the range's first byte
  };

  int checked_range(cn::MonoAddress address, std::uint64_t bytes) const;
  /// Storage of the range's first byte; null if its memory grants no pointer to all of it.
  std::uint8_t* pointer(int range, tlm::tlm_fw_transport_if<>& memory);
  std::uint8_t* ask(int range, tlm::tlm_fw_transport_if<>& memory) const;
  void move_by_debug(const cn::Transfer& transfer, tlm::tlm_fw_transport_if<>& memory);
  void debug(tlm::tlm_command command, cn::MonoAddress address, std::uint8_t* data, std::uint64_t bytes,
             tlm::tlm_fw_transport_if<>& memory);

  AddressMap own_map_;
  const AddressMap* map_ = &own_map_;
  cn::PolyMemory& poly_;
  std::vector<Pointer> pointers_;  ///< by range, those that were asked for
  std::vector<std::uint8_t> piece_;
  std::map<cn::MonoAddress, std::vector<std::uint8_t>> copies_;
};

}  // namespace model
