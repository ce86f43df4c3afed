#include "testbench/system/memory.hpp"

#include <algorithm>
#include <fstream>
#include <limits>

#include "testbench/system/error.hpp"

namespace testbench {
namespace {

constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint64_t>::max();

/// The number in a file of one; `otherwise` where there is none ("max", or no such file).
std::uint64_t number_in(const char* path, std::uint64_t otherwise) {
  std::uint64_t number = 0;
  return std::ifstream(path) >> number ? number : otherwise;
}

/// What the machine has left, swap included (proc(5), /proc/meminfo).
std::uint64_t available_bytes() {
  std::ifstream lines("/proc/meminfo");
  std::uint64_t kibibytes = 0;
  bool is_known = false;
  std::string name, unit;
  for (std::uint64_t value = 0; lines >> name >> value;) {
    std::getline(lines, unit);
    if (name != "MemAvailable:" && name != "SwapFree:") continue;
    kibibytes += value;
    is_known = true;
  }
  return is_known ? kibibytes * 1024 : kNoLimit;
}

/// What the control group has left, without its swap and with its caches as used (cgroups(7), version 2).
std::uint64_t group_bytes() {
  const std::uint64_t most = number_in("/sys/fs/cgroup/memory.max", kNoLimit);
  if (most == kNoLimit) return kNoLimit;
  const std::uint64_t used = number_in("/sys/fs/cgroup/memory.current", 0);
  return most - std::min(most, used);
}

}  // namespace

void require_memory(std::uint64_t bytes, const std::string& what) {
  constexpr std::uint64_t kAlwaysThere = std::uint64_t{1} << 28;
  if (bytes < kAlwaysThere) return;
  const std::uint64_t available = std::min(available_bytes(), std::max(group_bytes(), kAlwaysThere));
  if (bytes > available)
    throw RunError("out of memory: " + what + " needs " + std::to_string(bytes) + " bytes, " +
                   std::to_string(available) + " are available");
}

}  // namespace testbench
