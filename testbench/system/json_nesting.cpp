#include "testbench/system/json_nesting.hpp"

#include "testbench/system/error.hpp"

namespace testbench {

void require_shallow_json(const std::string& text, const std::string& where) {
  int depth = 0;
  bool is_in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (is_in_string) {
      if (c == '\\') ++i;
      if (c == '"') is_in_string = false;
      continue;
    }
    if (c == '"') is_in_string = true;
    if (c == ']' || c == '}') --depth;
    if ((c == '[' || c == '{') && ++depth > kMaxJsonNesting)
      throw InputError(where + ": found JSON nested deeper than " + std::to_string(kMaxJsonNesting) +
                       " levels, at byte " + std::to_string(i) +
                       "; allowed: " + std::to_string(kMaxJsonNesting) + " levels");
  }
}

}  // namespace testbench
