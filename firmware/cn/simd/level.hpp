#pragma once

#include <cstdint>

namespace cn {

/// Levels of the x86-64 instruction set that kernels are built for; the same bits come from each.
enum class Level : std::uint8_t { x86_64_v2, x86_64_v3, x86_64_v4 };

/// The widest level this machine executes.
inline Level widest_level() {
  if (__builtin_cpu_supports("x86-64-v4")) return Level::x86_64_v4;
  if (__builtin_cpu_supports("x86-64-v3")) return Level::x86_64_v3;
  return Level::x86_64_v2;
}

/// Of one function built for each level, the one for `level`.
template <class Function>
Function* at_level(Level level, Function* v2, Function* v3, Function* v4) {
  return level == Level::x86_64_v4 ? v4 : level == Level::x86_64_v3 ? v3 : v2;
}

}  // namespace cn
