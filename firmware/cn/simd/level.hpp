#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "firmware/cn/simd/built_levels.hpp"

namespace cn {

/// Levels of the x86-64 instruction set that kernels can be built for; the same bits come from each.
enum class Level : std::uint8_t { x86_64_v2, x86_64_v3, x86_64_v4 };

/// Thrown for a level that was not built, or that this processor does not execute; one line.
class LevelError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Returns "v2", "v3" or "v4".
std::string name_of(Level level);

bool processor_executes(Level level);

/// Levels that this build has kernels for, narrow to wide.
std::vector<Level> built_levels();

/// Built levels that the processor executes, narrow to wide. Throws LevelError if there is none.
std::vector<Level> usable_levels();
inline Level narrowest_level() {
  return usable_levels().front();
}
inline Level widest_level() {
  return usable_levels().back();
}

[[noreturn]] void fail_not_built(Level level);

/// Calls `get` with `level` as a std::integral_constant, for built levels only: so `get` may name, under `if
/// constexpr`, what no other build has. Throws LevelError for a level that was not built.
template <class Get>
decltype(auto) at_level(Level level, const Get& get) {
  if constexpr (kBuildsV4) {
    if (level == Level::x86_64_v4) return get(std::integral_constant<Level, Level::x86_64_v4>{});
  }
  if constexpr (kBuildsV3) {
    if (level == Level::x86_64_v3) return get(std::integral_constant<Level, Level::x86_64_v3>{});
  }
  if constexpr (kBuildsV2) {
    if (level == Level::x86_64_v2) return get(std::integral_constant<Level, Level::x86_64_v2>{});
  }
  fail_not_built(level);
}

}  // namespace cn
