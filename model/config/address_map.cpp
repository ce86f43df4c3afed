#include "model/config/address_map.hpp"

#include <cinttypes>
#include <cstdio>

namespace model {
namespace {

std::string text_of(const cn::MonoRange& range) {
  return hexadecimal(range.first) + " to " + hexadecimal(range.first + range.bytes - 1);
}

}  // namespace

std::string hexadecimal(std::uint64_t value) {
  char digits[2 + 16 + 1];
  std::snprintf(digits, sizeof(digits), "0x%" PRIx64, value);
  return digits;
}

void AddressMap::add(const std::string& name, const cn::MonoRange& range) {
  const std::string found = "address map: " + name + ": found " + std::to_string(range.bytes) + " bytes at " +
                            hexadecimal(range.first) + "; allowed: ";
  if (range.bytes == 0) throw AddressMapError(found + "at least 1 byte");
  if (range.bytes - 1 > ~cn::MonoAddress{0} - range.first)
    throw AddressMapError(found + "a last byte at " + hexadecimal(~std::uint64_t{0}) + " or before");
  for (const Range& other : ranges_) {
    if (other.name == name)
      throw AddressMapError("address map: found two ranges '" + name + "'; allowed: one");
    const cn::MonoAddress last = range.first + (range.bytes - 1);
    const cn::MonoAddress last_of_other = other.mono.first + (other.mono.bytes - 1);
    if (range.first <= last_of_other && other.mono.first <= last)
      throw AddressMapError(found + "addresses outside " + other.name + " (" + text_of(other.mono) + ")");
  }
  ranges_.push_back({name, range});
}

std::string AddressMap::text() const {
  std::string text;
  for (const Range& range : ranges_) text += (text.empty() ? "" : " and ") + text_of(range.mono);
  return text;
}

AddressMap address_map(const ChipConfig& config) {
  AddressMap map;
  map.add(kDdrRange, {0, config.ddr.size_bytes});
  if (config.on_chip_sram.size_bytes > 0) map.add(kOnChipSramRange, on_chip_sram_range(config));
  if (config.search_unit.units > 0) map.add(kSearchUnitRange, search_unit_range(config));
  return map;
}

}  // namespace model
