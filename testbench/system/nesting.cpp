#include "testbench/system/nesting.hpp"

#include <algorithm>
#include <vector>

#include "testbench/system/error.hpp"

namespace testbench {
namespace {

/// The levels that are open at a place of a text.
class NestingDepth {
 public:
  explicit NestingDepth(const std::string& origin, std::size_t first_line = 1)
      : origin_(origin), line_(first_line) {}

  void next_line() {
    ++line_;
    next_key();
  }
  void next_key() { dots_ = 0; }
  void dot() {
    ++dots_;
    require_shallow();
  }
  /// A value that holds others; the parts of its key are levels, too.
  void open() {
    levels_.push_back(dots_ + 1);
    depth_ += levels_.back();
    dots_ = 0;
    require_shallow();
  }
  void close() {
    if (levels_.empty()) return;
    depth_ -= levels_.back();
    levels_.pop_back();
  }

 private:
  void require_shallow() const {
    if (depth_ + dots_ > kMostNesting)
      throw InputError(origin_ + ":" + std::to_string(line_) + ": found values nested more than " +
                       std::to_string(kMostNesting) + " deep; allowed: at most " +
                       std::to_string(kMostNesting) + " levels");
  }

  const std::string& origin_;
  std::size_t line_;
  std::size_t dots_ = 0;  ///< of the key that is being read
  std::size_t depth_ = 0;
  std::vector<std::size_t> levels_;  ///< of each bracket that is open; at most kMostNesting
};

/// The place of the quote that ends the string that begins at `begin`; the end of the line or text if none
/// does.
std::size_t end_of_string(std::string_view text, std::size_t begin, bool has_escapes, char line_end) {
  const char quote = text[begin];
  for (std::size_t i = begin + 1; i < text.size(); ++i) {
    if (text[i] == quote) return i;
    if (text[i] == line_end) return i - 1;
    if (text[i] == '\\' && has_escapes) ++i;
  }
  return text.size();
}

/// The same of a TOML string between triple quotes. It counts the lines that it holds.
std::size_t end_of_long_string(std::string_view text, std::size_t begin, NestingDepth& depth) {
  const std::string_view quotes = text.substr(begin, 3);
  std::size_t i = begin + 3;
  for (; i < text.size() && text.substr(i, 3) != quotes; ++i) {
    if (text[i] == '\\' && quotes[0] == '"') ++i;
    if (i < text.size() && text[i] == '\n') depth.next_line();
  }
  // One or two quotes more may be the string's last characters.
  i += 2;
  for (int more = 0; more < 2 && i + 1 < text.size() && text[i + 1] == quotes[0]; ++more) ++i;
  return i;
}

/// The last character of the TOML string that begins at `begin`.
std::size_t end_of_toml_string(std::string_view text, std::size_t begin, NestingDepth& depth) {
  const std::string three(3, text[begin]);
  if (text.substr(begin, 3) == three) return end_of_long_string(text, begin, depth);
  return end_of_string(text, begin, text[begin] == '"', '\n');
}

}  // namespace

void require_shallow_json(std::string_view text, const std::string& origin, std::size_t first_line) {
  NestingDepth depth(origin, first_line);
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') i = end_of_string(text, i, true, '\n');
    if (c == '\n') depth.next_line();
    if (c == '[' || c == '{') depth.open();
    if (c == ']' || c == '}') depth.close();
  }
}

void require_shallow_toml(std::string_view text, const std::string& origin) {
  NestingDepth depth(origin);
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"' || c == '\'') i = end_of_toml_string(text, i, depth);
    if (c == '#') i = std::min(text.find('\n', i), text.size()) - 1;
    if (c == '\n') depth.next_line();
    if (c == '.') depth.dot();
    if (c == ',') depth.next_key();
    if (c == '[' || c == '{') depth.open();
    if (c == ']' || c == '}') depth.close();
  }
}

}  // namespace testbench
