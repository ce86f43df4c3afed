#include "testbench/files/text_lines.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "testbench/system/error.hpp"
#include "testbench/system/message_text.hpp"

namespace testbench {
namespace {

bool is_blank(char character) {
  return character == ' ' || character == '\t';
}

}  // namespace

std::string_view take_word(std::string_view& line) {
  std::size_t begin = 0;
  while (begin < line.size() && is_blank(line[begin])) ++begin;
  std::size_t end = begin;
  while (end < line.size() && !is_blank(line[end])) ++end;
  const std::string_view word = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return word;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string lower_case(std::string_view text) {
  std::string result(text);
  for (char& character : result)
    if (character >= 'A' && character <= 'Z') character = char(character - 'A' + 'a');
  return result;
}

std::string_view without_comment(std::string_view line) {
  for (std::size_t i = line.find('#'); i != std::string_view::npos; i = line.find('#', i + 1))
    if (i == 0 || is_blank(line[i - 1])) return line.substr(0, i);
  return line;
}

bool parse_number(std::string_view word, double& value) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-')
    word.remove_prefix(1);  // from_chars knows only '-'
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size() && std::isfinite(value);
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kMost = 100;
  return "'" + shortened(printable(text), kMost) + "'";
}

std::string_view without_byte_order_mark(std::string_view text) {
  if (text.substr(0, 3) == "\xef\xbb\xbf") text.remove_prefix(3);
  return text;
}

void require_no_utf_16(const std::filesystem::path& file, std::string_view text) {
  const std::string_view mark = text.substr(0, 2);
  if (mark == "\xfe\xff" || mark == "\xff\xfe")
    throw InputError(file.string() + ":1: found text in UTF-16; allowed: UTF-8 or ASCII");
}

std::string_view LineReader::take_physical_line() {
  std::size_t end = 0;
  while (end < rest_.size() && rest_[end] != '\n' && rest_[end] != '\r') ++end;
  const std::string_view line = rest_.substr(0, end);
  const std::size_t ending = rest_.substr(end, 2) == "\r\n" ? 2 : 1;
  rest_.remove_prefix(std::min(end + ending, rest_.size()));
  ++lines_read_;
  return line;
}

bool LineReader::next() {
  if (rest_.empty()) return false;
  line_ = take_physical_line();
  number_ = lines_read_;
  const auto is_continued = [](std::string_view line) {
    return !line.empty() && line.back() == '\\' && without_comment(line).size() == line.size();
  };
  if (!is_continued(line_)) return true;
  joined_.assign(line_);
  while (is_continued(joined_) && !rest_.empty()) {
    joined_.back() = ' ';
    joined_ += take_physical_line();
  }
  if (joined_.back() == '\\') joined_.pop_back();
  line_ = joined_;
  return true;
}

}  // namespace testbench
