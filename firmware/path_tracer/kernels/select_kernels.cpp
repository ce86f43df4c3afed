#include "firmware/path_tracer/kernels/kernels.hpp"

namespace path_tracer {

namespace level_x86_64_v2 {
const Kernels& kernel_table();
}
namespace level_x86_64_v3 {
const Kernels& kernel_table();
}
namespace level_x86_64_v4 {
const Kernels& kernel_table();
}
namespace level_observed {
const Kernels& kernel_table();
}

const Kernels& kernels(Level level) {
  return cn::at_level(level, [](auto built) -> const Kernels& {
    if constexpr (built == cn::Level::x86_64_v4) return level_x86_64_v4::kernel_table();
    if constexpr (built == cn::Level::x86_64_v3) return level_x86_64_v3::kernel_table();
    if constexpr (built == cn::Level::x86_64_v2) return level_x86_64_v2::kernel_table();
  });
}

const Kernels& observed_kernels() {
  return level_observed::kernel_table();
}

}  // namespace path_tracer
