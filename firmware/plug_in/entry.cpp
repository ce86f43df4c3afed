// Compiled into every plug-in: the one symbol that it exports.

#include "firmware/plug_in/entry.hpp"

#include <algorithm>

// What csx600_add_firmware() names make_firmware() of each level; null where a level was not built.
extern "C" {
[[gnu::weak]] void csx600_firmware_x86_64_v2();
[[gnu::weak]] void csx600_firmware_x86_64_v3();
[[gnu::weak]] void csx600_firmware_x86_64_v4();
[[gnu::weak]] void csx600_firmware_observed();
}

namespace plug_in {
namespace {

Make made_by(void (*symbol)()) {
  return reinterpret_cast<Make>(symbol);
}

Entry entry() {
  Entry entry{{},
              {made_by(csx600_firmware_x86_64_v2), made_by(csx600_firmware_x86_64_v3),
               made_by(csx600_firmware_x86_64_v4)},
              made_by(csx600_firmware_observed)};
  std::copy(std::begin(kInterfaceVersion), std::end(kInterfaceVersion), entry.version);
  return entry;
}

}  // namespace
}  // namespace plug_in

extern "C" {
extern const plug_in::Entry csx600_firmware;
const plug_in::Entry csx600_firmware = plug_in::entry();
}
