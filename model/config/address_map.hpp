#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/cn/chip/mono_range.hpp"
#include "model/config/chip_config.hpp"

namespace model {

/// An address map that cannot be. The message is one line: what was found, what is allowed.
class AddressMapError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Which memory answers at which mono addresses. Ranges do not overlap; holes between them belong to nobody.
class AddressMap {
 public:
  struct Range {
    std::string name;
    cn::MonoRange mono;
  };
  static constexpr int kNowhere = -1;

  /// Throws AddressMapError for a range without bytes, one that goes beyond the last address, one that
  /// overlaps another, or a name that is taken.
  void add(const std::string& name, const cn::MonoRange& range);

  /// The number of the range that holds all these bytes, or kNowhere: a transfer lies within one range.
  int find(cn::MonoAddress address, std::uint64_t bytes) const {
    for (std::size_t i = 0; i < ranges_.size(); ++i)
      if (ranges_[i].mono.contains(address, bytes)) return static_cast<int>(i);
    return kNowhere;
  }
  const Range& operator[](int number) const { return ranges_[std::size_t(number)]; }
  int size() const { return static_cast<int>(ranges_.size()); }

  /// For messages: "0x0 to 0xfffff and 0x10000000000 to 0x1000001ffff".
  std::string text() const;

 private:
  std::vector<Range> ranges_;
};

/// "0x1f".
std::string hexadecimal(std::uint64_t value);

/// The memories of the chip itself: the DDR from address 0, the on-chip SRAM and the search unit's buffer if
/// it has them.
AddressMap address_map(const ChipConfig& config);

inline constexpr const char* kDdrRange = "ddr";
inline constexpr const char* kOnChipSramRange = "on_chip_sram";

inline constexpr const char* kSearchUnitRange = "search_unit";

inline cn::MonoRange on_chip_sram_range(const ChipConfig& config) {
  return {config.on_chip_sram.first_address, config.on_chip_sram.size_bytes};
}
/// Of its buffer; empty if the chip has no search unit.
inline cn::MonoRange search_unit_range(const ChipConfig& config) {
  return {config.search_unit.first_address,
          config.search_unit.units > 0 ? config.search_unit.buffer_bytes : 0};
}

}  // namespace model
