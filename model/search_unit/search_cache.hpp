#pragma once

#include <cstdint>
#include <vector>

#include "firmware/cn/chip/mono_memory.hpp"

namespace model {

/// Which lines of mono memory a unit holds: set-associative, the line that was used longest ago is replaced.
/// Lines on the way from memory have their place already.
class SearchCache {
 public:
  enum class Found : std::uint8_t { here, on_the_way, missing };

  /// @param bytes a multiple of line_bytes x ways
  SearchCache(int bytes, int line_bytes, int ways)
      : line_bytes_(std::uint64_t(line_bytes)),
        ways_(std::size_t(ways)),
        sets_(std::size_t(bytes) / (std::size_t(line_bytes) * std::size_t(ways))),
        entries_(sets_ * ways_) {}

  std::uint64_t line_bytes() const { return line_bytes_; }
  std::uint64_t line_of(cn::MonoAddress address) const { return address / line_bytes_; }

  /// Looks for a line. A missing one takes a place, unless all places of its set wait for their lines.
  Found look_up(std::uint64_t line) {
    Entry* const set = set_of(line);
    Entry* oldest = nullptr;
    for (std::size_t way = 0; way < ways_; ++way) {
      Entry& entry = set[way];
      if (entry.line == line) {
        entry.last_use = ++uses_;
        return entry.on_the_way ? Found::on_the_way : Found::here;
      }
      if (!entry.on_the_way && (oldest == nullptr || entry.last_use < oldest->last_use)) oldest = &entry;
    }
    if (oldest != nullptr) *oldest = {line, ++uses_, true};
    return Found::missing;
  }

  void arrived(std::uint64_t line) {
    Entry* const set = set_of(line);
    for (std::size_t way = 0; way < ways_; ++way)
      if (set[way].line == line) set[way].on_the_way = false;
  }

  /// Forgets all lines but those on the way.
  void clear() {
    for (Entry& entry : entries_)
      if (!entry.on_the_way) entry = {};
  }

 private:
  struct Entry {
    std::uint64_t line = ~std::uint64_t{0};
    std::uint64_t last_use = 0;
    bool on_the_way = false;
  };
  Entry* set_of(std::uint64_t line) { return &entries_[std::size_t(line % sets_) * ways_]; }

  std::uint64_t line_bytes_;
  std::size_t ways_;
  std::size_t sets_;
  std::vector<Entry> entries_;
  std::uint64_t uses_ = 0;
};

}  // namespace model
