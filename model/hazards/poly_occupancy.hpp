#pragma once

#include <cstdint>
#include <vector>

#include "firmware/cn/chip/access_observer.hpp"
#include "firmware/cn/chip/lane_mask.hpp"
#include "firmware/cn/chip/poly_memory.hpp"

namespace model {

/// Which 8-byte words of which PEs' SRAM outstanding transfers read and write: one bit per PE and word, so
/// that a kernel's access is judged by one look.
class PolyOccupancy {
 public:
  explicit PolyOccupancy(const cn::PolyMemory& memory);

  void add(cn::Access access, cn::PolySpan span, const cn::LaneMask& pes);
  /// Clears the bits of all transfers there; the caller adds those that stay again.
  void remove(cn::Access access, cn::PolySpan span, const cn::LaneMask& pes);

  /// A word that a PE touches although a transfer uses it.
  struct Conflict {
    int offset_bytes = -1;  ///< none when negative
    int pe = -1;
  };
  /// An access by the PEs first_pe + i, for every bit i of `pes`.
  Conflict find(cn::Access access, cn::PolySpan bytes, int first_pe, std::uint32_t pes) const;
  Conflict find(cn::Access access, cn::PolySpan bytes, const cn::LaneMask& pes) const;

 private:
  using Bits = std::vector<std::uint8_t>;
  Bits& bits(cn::Access access) { return access == cn::Access::write ? written_ : read_; }
  template <class Change>  // (std::uint8_t& bits, std::uint8_t pes) -> void
  void change(Bits& all, cn::PolySpan span, const cn::LaneMask& pes, Change&& change_bits);

  int strips_;
  Bits written_;  ///< strip s of word w is at [w * strips_ + s]
  Bits read_;
};

}  // namespace model
