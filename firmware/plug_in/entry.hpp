#pragma once

#include "firmware/plug_in/firmware.hpp"
#include "firmware/plug_in/interface_version.hpp"

namespace plug_in {

using Make = std::unique_ptr<Firmware> (*)();

inline constexpr std::size_t kVersionBytes = 64;
static_assert(sizeof(kInterfaceVersion) <= kVersionBytes);

/// What a plug-in exports under the name kEntrySymbol. The version stays the first member for ever, so that
/// a program can refuse a plug-in of any other version.
struct Entry {
  char version[kVersionBytes];
  Make at_level[3];  ///< by cn::Level; null for a level that the plug-in was not built for
  Make observed;     ///< with kernels that report their SRAM accesses
};

inline constexpr const char* kEntrySymbol = "csx600_firmware";

}  // namespace plug_in
