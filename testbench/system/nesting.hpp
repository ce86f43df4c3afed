#pragma once

#include <string>
#include <string_view>

namespace testbench {

/// The deepest that JSON and TOML files may nest. What csx600 writes nests less than ten deep; libraries that
/// parse such files, and destroy what they parsed, recurse once a level.
inline constexpr std::size_t kMostNesting = 64;

/// Looks at the raw text, before anything parses it, in time linear in its size and without recursion. Throws
/// InputError, one line that names `origin` and the line, where objects and arrays nest deeper than
/// kMostNesting. A text that is no JSON passes as far as its brackets do.
/// @param origin "run.json"
/// @param first_line the number of the text's first line in its file
void require_shallow_json(std::string_view text, const std::string& origin, std::size_t first_line = 1);

/// The same of TOML, where each part of a dotted key is a level, too.
void require_shallow_toml(std::string_view text, const std::string& origin);

}  // namespace testbench
