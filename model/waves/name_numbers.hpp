#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

namespace model {

/// Numbers from 1 for names, in the order in which they first appear. Names are string literals, compared by
/// address.
class NameNumbers {
 public:
  std::uint64_t operator()(const char* name) {
    const auto found = std::find(literals_.begin(), literals_.end(), name);
    const auto index = std::uint64_t(found - literals_.begin());
    if (found == literals_.end()) {
      literals_.push_back(name);
      names_.emplace_back(name);
    }
    return index + 1;
  }
  /// The first has number 1.
  const std::vector<std::string>& names() const { return names_; }

 private:
  std::vector<const char*> literals_;
  std::vector<std::string> names_;
};

}  // namespace model
