#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

// Lines, words and numbers of the text formats OBJ, MTL and PLY. Numbers are read correctly rounded, whole
// words at a time: a word such as "1x" is no number.

namespace testbench {

/// Removes the next word, which ends at a blank or a tab, from the front of `line` and returns it; empty at
/// the end of the line.
std::string_view take_word(std::string_view& line);

/// The text without blanks and tabs at its ends.
std::string_view trimmed(std::string_view text);

/// The text with its ASCII letters in lower case.
std::string lower_case(std::string_view text);

/// The line up to a comment, which begins with '#' at the start of a word.
std::string_view without_comment(std::string_view line);

/// Whether the whole word is a finite decimal number; sets `value` to it. A leading '+' is allowed.
bool parse_number(std::string_view word, double& value);

/// The text in quotes for an error message: printable, and shortened to 100 characters.
std::string in_quotes(std::string_view text);

/// The text without the byte order mark that some editors put in front of UTF-8.
std::string_view without_byte_order_mark(std::string_view text);

/// Throws InputError if a byte order mark says that the text of `file` is UTF-16.
void require_no_utf_16(const std::filesystem::path& file, std::string_view text);

/// Reads a text line by line. A line ends with \n, \r\n or \r, unless a backslash stands right before its
/// end: then the next line continues it as after a blank (Wavefront's OBJ). Comments are not continued.
class LineReader {
 public:
  explicit LineReader(std::string_view text) : rest_(without_byte_order_mark(text)) {}

  /// Moves on to the next line; false at the end of the text.
  bool next();

  std::string_view line() const { return line_; }
  /// The number of the line that line() begins on, from 1.
  std::size_t number() const { return number_; }

 private:
  std::string_view take_physical_line();

  std::string_view rest_;
  std::string_view line_;
  std::string joined_;  ///< the text of a continued line
  std::size_t number_ = 0;
  std::size_t lines_read_ = 0;
};

}  // namespace testbench
