#pragma once

#include <string>

namespace testbench {

/// How many arrays and objects may lie within each other in a JSON file that is read. A file of ours has less
/// than ten; readers that recurse need far less stack for this many than a program has.
inline constexpr int kMaxJsonNesting = 128;

/// Throws InputError if brackets of `text`, outside its strings, nest deeper than kMaxJsonNesting. It looks
/// at each byte once and needs no memory, so it is called before a parser is.
/// @param where the file, or file and line, in the message
void require_shallow_json(const std::string& text, const std::string& where);

}  // namespace testbench
