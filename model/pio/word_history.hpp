#pragma once

#include <cstdint>
#include <vector>

#include "model/time/cycles.hpp"

namespace model {

/// How many words an engine has moved by a cycle: linear within each request, the latest of which are
/// remembered.
class WordHistory {
 public:
  /// @param requests how many of the latest are remembered; a power of two
  explicit WordHistory(std::size_t requests) : recent_(requests) {}

  /// Requests follow each other: `first` is not before the `last` of the one before.
  void add(Cycles first, Cycles last, std::uint64_t words);

  /// Words moved before `cycle`, which must not lie before the remembered requests.
  std::uint64_t before(Cycles cycle) const;

 private:
  struct Request {
    Cycles first = 0;
    Cycles last = 0;
    std::uint64_t words = 0;
    std::uint64_t words_before = 0;
  };

  std::vector<Request> recent_;
  std::size_t added_ = 0;
  std::uint64_t total_words_ = 0;
};

}  // namespace model
