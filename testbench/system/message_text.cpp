#include "testbench/system/message_text.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>

namespace testbench {
namespace {

constexpr std::string_view kEllipsis = "...";

bool continues_character(char byte) {
  return (static_cast<unsigned char>(byte) & 0xc0) == 0x80;
}

struct Character {
  std::size_t bytes = 0;  ///< 0: no valid UTF-8
  std::uint32_t code = 0;
};

/// The first character of a text that is not empty. Overlong forms, surrogates and codes above U+10FFFF are
/// not UTF-8 (RFC 3629, section 3).
Character first_character(std::string_view text) {
  const auto lead = static_cast<unsigned char>(text[0]);
  if (lead < 0x80) return {1, lead};
  const std::size_t bytes = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
  if (lead < 0xc2 || lead > 0xf4 || text.size() < bytes) return {};
  std::uint32_t code = lead & (0xffu >> (bytes + 1));
  for (std::size_t i = 1; i < bytes; ++i) {
    if (!continues_character(text[i])) return {};
    code = code << 6 | (static_cast<unsigned char>(text[i]) & 0x3f);
  }
  constexpr std::array<std::uint32_t, 5> kLeastCode = {0, 0, 0x80, 0x800, 0x10000};
  const bool is_surrogate = code >= 0xd800 && code < 0xe000;
  if (code < kLeastCode[bytes] || code > 0x10ffff || is_surrogate) return {};
  return {bytes, code};
}

/// Control characters (Unicode category Cc), line and paragraph separators, and the marks of bidirectional
/// text.
bool is_printable(std::uint32_t code) {
  const auto is_in = [code](std::uint32_t first, std::uint32_t last) {
    return code >= first && code <= last;
  };
  return !(is_in(0, 0x1f) || is_in(0x7f, 0x9f) || is_in(0x200e, 0x200f) || is_in(0x2028, 0x202e) ||
           is_in(0x2066, 0x2069) || code == 0x061c || code == 0xfeff);
}

std::string escaped(std::string_view bytes) {
  if (bytes == "\n") return "\\n";
  if (bytes == "\r") return "\\r";
  if (bytes == "\t") return "\\t";
  std::string text;
  for (const char byte : bytes) {
    std::array<char, 5> digits;
    std::snprintf(digits.data(), digits.size(), "\\x%02x", static_cast<unsigned char>(byte));
    text += digits.data();
  }
  return text;
}

std::size_t characters_of(std::string_view text) {
  return text.size() - std::size_t(std::count_if(text.begin(), text.end(), continues_character));
}

/// The place of the character with this number.
std::size_t place_of(std::string_view text, std::size_t number) {
  std::size_t place = 0;
  while (place < text.size() && (continues_character(text[place]) || number-- > 0)) ++place;
  return place;
}

/// Shortens the part of `line` from `first` to `last`; returns where it ends then.
std::size_t shorten(std::string& line, std::size_t first, std::size_t last) {
  const std::string part = shortened(std::string_view(line).substr(first, last - first));
  line.replace(first, last - first, part);
  return first + part.size();
}

/// What stands before "found", the file and the key, and what was found: up to "; allowed" or ", allowed".
void shorten_found(std::string& line) {
  constexpr std::string_view kFound = "found ";
  const std::size_t found = line.find(kFound);
  if (found == std::string::npos) return;
  const std::size_t end = shorten(line, 0, found) + kFound.size();
  std::size_t allowed = std::max(line.rfind("; allowed") + 1, line.rfind(", allowed") + 1);
  if (allowed > end) shorten(line, end, allowed - 1);
}

/// A quote opens behind a blank or a bracket and closes before a blank or a mark, so an apostrophe is none.
void shorten_quoted(std::string& line) {
  const auto is_one_of = [&](std::size_t place, std::string_view set) {
    return place >= line.size() || set.find(line[place]) != std::string_view::npos;
  };
  for (std::size_t open = line.find('\''); open != std::string::npos; open = line.find('\'', open + 1)) {
    if (open > 0 && !is_one_of(open - 1, " ([")) continue;
    std::size_t close = line.find('\'', open + 1);
    while (close != std::string::npos && !is_one_of(close + 1, " ,;:.)]?"))
      close = line.find('\'', close + 1);
    if (close == std::string::npos) return;
    open = shorten(line, open + 1, close);
  }
}

void shorten_words(std::string& line) {
  for (std::size_t first = 0; first < line.size(); ++first) {
    const std::size_t blank = line.find(' ', first);
    first = shorten(line, first, std::min(blank, line.size()));
  }
}

}  // namespace

std::string printable(std::string_view text) {
  std::string line;
  while (!text.empty()) {
    const Character character = first_character(text);
    const std::string_view bytes = text.substr(0, std::max<std::size_t>(character.bytes, 1));
    line += character.bytes > 0 && is_printable(character.code) ? std::string(bytes) : escaped(bytes);
    text.remove_prefix(bytes.size());
  }
  return line;
}

std::string shortened(std::string_view text, std::size_t most) {
  const std::size_t characters = characters_of(text);
  if (characters <= most) return std::string(text);
  const std::size_t kept = most - kEllipsis.size();
  const std::size_t tail = kept / 4;
  return std::string(text.substr(0, place_of(text, kept - tail))) + std::string(kEllipsis) +
         std::string(text.substr(place_of(text, characters - tail)));
}

std::string message_line(std::string_view message) {
  std::string line = printable(message);
  if (characters_of(line) <= kMostQuotedCharacters) return line;
  shorten_found(line);
  shorten_quoted(line);
  shorten_words(line);
  return shortened(line, kMostMessageCharacters);
}

}  // namespace testbench
