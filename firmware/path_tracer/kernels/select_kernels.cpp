#include "firmware/path_tracer/kernels/kernels.hpp"

namespace path_tracer {

const Kernels& kernels_x86_64_v2();
const Kernels& kernels_x86_64_v3();
const Kernels& kernels_x86_64_v4();
const Kernels& kernels_observed();

const Kernels& kernels(Level level) {
  return cn::at_level(level, [](auto built) -> const Kernels& {
    if constexpr (built == cn::Level::x86_64_v4) return kernels_x86_64_v4();
    if constexpr (built == cn::Level::x86_64_v3) return kernels_x86_64_v3();
    if constexpr (built == cn::Level::x86_64_v2) return kernels_x86_64_v2();
  });
}

const Kernels& observed_kernels() {
  return kernels_observed();
}

}  // namespace path_tracer
