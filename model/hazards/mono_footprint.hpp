#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "firmware/cn/chip/mono_range.hpp"
#include "firmware/cn/chip/transfer.hpp"

namespace model {

using cn::MonoRange;

/// Where a transfer touches mono memory: a piece of equal length for each enabled PE. An array is kept as its
/// start and stride, a gather's or scatter's addresses are copied.
class MonoFootprint {
 public:
  MonoFootprint(const cn::Transfer& transfer, int num_pes);
  /// One piece.
  explicit MonoFootprint(const MonoRange& range);

  /// The first bytes that both touch.
  std::optional<MonoRange> overlap(const MonoFootprint& other) const;

 private:
  std::vector<cn::MonoAddress> ascending_starts() const;

  std::uint64_t piece_bytes_ = 0;
  cn::MonoAddress low_ = 0;  ///< every piece lies in [low_, high_)
  cn::MonoAddress high_ = 0;
  cn::LaneMask enabled_;
  int num_pes_ = 0;
  cn::MonoPlaces array_;
  std::vector<cn::MonoAddress> starts_;  ///< by enabled PE, for a gather or scatter; empty for an array
};

}  // namespace model
