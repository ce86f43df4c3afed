#pragma once

#include <cstdint>
#include <vector>

#include "firmware/cn/chip/mono_memory.hpp"

namespace model {

/// Which lines of mono memory the control unit's data cache holds. Direct-mapped (assumed; the vendor states
/// size and associativity nowhere that is public).
class DataCache {
 public:
  /// @param bytes a multiple of line_bytes
  DataCache(int bytes, int line_bytes)
      : line_bytes_(std::uint64_t(line_bytes)), tags_(std::size_t(bytes / line_bytes), kEmpty) {}

  /// No line is in the cache.
  void clear() { tags_.assign(tags_.size(), kEmpty); }
  std::uint64_t line_bytes() const { return line_bytes_; }
  std::uint64_t line_of(cn::MonoAddress address) const { return address / line_bytes_; }

  /// Whether the line is in the cache. If not, it is loaded.
  bool touch(std::uint64_t line) {
    std::uint64_t& tag = tags_[std::size_t(line % tags_.size())];
    const bool hit = tag == line;
    tag = line;
    return hit;
  }

 private:
  static constexpr std::uint64_t kEmpty = ~std::uint64_t{0};

  std::uint64_t line_bytes_;
  std::vector<std::uint64_t> tags_;
};

}  // namespace model
