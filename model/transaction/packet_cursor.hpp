#pragma once

#include <algorithm>
#include <cstdint>

#include "model/transaction/mono_pieces.hpp"

namespace model {

/// The packets of a PIO request one by one: each run is cut into packets from its start.
class PacketCursor {
 public:
  struct Packet {
    cn::MonoAddress address;
    std::uint64_t bytes;
    int first_piece;  ///< first of the pieces that it holds, in the order of the request
    int last_piece;
  };

  PacketCursor() = default;
  PacketCursor(const MonoPieces& pieces, std::uint64_t packet_bytes)
      : pieces_(&pieces),
        packet_bytes_(packet_bytes),
        bytes_per_piece_(std::uint64_t(pieces.bytes_per_pe())) {
    look();
  }

  bool at_end() const { return run_ == pieces_->runs().size(); }
  /// Must not be called at the end.
  const Packet& packet() const { return packet_; }
  void advance() {
    offset_ += packet_.bytes;
    if (offset_ == pieces_->runs()[run_].bytes) {
      first_piece_of_run_ += static_cast<int>(offset_ / bytes_per_piece_);
      offset_ = 0;
      ++run_;
    }
    look();
  }

 private:
  void look() {
    if (at_end()) return;
    const MonoPieces::Run& run = pieces_->runs()[run_];
    packet_.address = run.address + offset_;
    packet_.bytes = std::min(packet_bytes_, run.bytes - offset_);
    packet_.first_piece = first_piece_of_run_ + static_cast<int>(offset_ / bytes_per_piece_);
    packet_.last_piece =
        first_piece_of_run_ + static_cast<int>((offset_ + packet_.bytes - 1) / bytes_per_piece_);
  }

  const MonoPieces* pieces_ = nullptr;
  std::uint64_t packet_bytes_ = 0;
  std::uint64_t bytes_per_piece_ = 0;
  std::size_t run_ = 0;
  std::uint64_t offset_ = 0;  ///< of the packet within the run
  int first_piece_of_run_ = 0;
  Packet packet_{};
};

}  // namespace model
