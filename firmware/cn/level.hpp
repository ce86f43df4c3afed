#pragma once

#include <cstdint>

namespace cn {

/// Levels of the x86-64 instruction set that kernels are built for; the same bits come from each.
enum class Level : std::uint8_t { x86_64_v2, x86_64_v3, x86_64_v4 };

}  // namespace cn
