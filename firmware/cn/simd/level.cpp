#include "firmware/cn/simd/level.hpp"

namespace cn {
namespace {

std::string names_of(const std::vector<Level>& levels) {
  std::string names;
  for (const Level level : levels) names += (names.empty() ? "" : ", ") + name_of(level);
  return names;
}

}  // namespace

bool processor_executes(Level level) {
#if defined(__clang__)
  // Clang 14 knows features only: those of a level, as AMD64's psABI lists them, that it has names for.
  const bool v2 = __builtin_cpu_supports("sse4.2") && __builtin_cpu_supports("popcnt");
  const bool v3 = v2 && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                  __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
  const bool v4 = v3 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                  __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
                  __builtin_cpu_supports("avx512vl");
  return level == Level::x86_64_v4 ? v4 : level == Level::x86_64_v3 ? v3 : v2;
#else
  if (level == Level::x86_64_v4) return __builtin_cpu_supports("x86-64-v4") != 0;
  if (level == Level::x86_64_v3) return __builtin_cpu_supports("x86-64-v3") != 0;
  return __builtin_cpu_supports("x86-64-v2") != 0;
#endif
}

std::string name_of(Level level) {
  return "v" + std::to_string(2 + static_cast<int>(level));
}

std::vector<Level> built_levels() {
  std::vector<Level> levels;
  if (kBuildsV2) levels.push_back(Level::x86_64_v2);
  if (kBuildsV3) levels.push_back(Level::x86_64_v3);
  if (kBuildsV4) levels.push_back(Level::x86_64_v4);
  return levels;
}

std::vector<Level> usable_levels() {
  std::vector<Level> levels;
  for (const Level level : built_levels())
    if (processor_executes(level)) levels.push_back(level);
  if (levels.empty())
    throw LevelError("this build has kernels for x86-64 level " + names_of(built_levels()) +
                     ", which this processor does not execute: configure with -DCSX600_LEVELS=all");
  return levels;
}

void fail_not_built(Level level) {
  throw LevelError("x86-64 level " + name_of(level) + " was not built: this build has " +
                   names_of(built_levels()) + " (CSX600_LEVELS)");
}

}  // namespace cn
