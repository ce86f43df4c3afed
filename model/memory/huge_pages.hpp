#pragma once

#include <sys/mman.h>

#include <cstdint>

namespace model {

inline constexpr std::uint64_t kHugePageBytes = std::uint64_t{2} << 20;

/// Asks the operating system for huge pages within these bytes, which nobody has touched yet. Records of a
/// pass lie all over mono memory and results all over the film; with small pages each address translation
/// costs the simulator a page walk. The operating system may refuse; no result depends on it.
inline void prefer_huge_pages(void* first, std::uint64_t bytes) {
  const auto address = reinterpret_cast<std::uintptr_t>(first);
  const std::uintptr_t begin = (address + kHugePageBytes - 1) / kHugePageBytes * kHugePageBytes;
  const std::uintptr_t end = (address + bytes) / kHugePageBytes * kHugePageBytes;
  if (begin < end) madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
}

}  // namespace model
