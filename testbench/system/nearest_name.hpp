#pragma once

#include <string>
#include <vector>

namespace testbench {

/// The name that a misspelt `word` most likely means; "" if no name has a letter in the same place.
std::string nearest_name(const std::string& word, const std::vector<std::string>& names);

}  // namespace testbench
