#pragma once

#include <cstddef>
#include <string>
#include <string_view>

/// Messages quote names and values of files and command lines, which may hold anything. What is printed is
/// one line of printable UTF-8 that is not flooded by what it quotes.
namespace testbench {

/// Characters of the input that one message quotes in a piece, at most.
inline constexpr std::size_t kMostQuotedCharacters = 300;
/// Characters of a whole message, at most.
inline constexpr std::size_t kMostMessageCharacters = 1000;

/// The text with control characters, line separators, characters that change the direction of writing and
/// bytes that are not UTF-8 as escapes: \n, \t, \r, otherwise \xNN for each byte.
std::string printable(std::string_view text);

/// The text, its middle replaced by "..." if it has more than `most` characters. `text` must be UTF-8.
std::string shortened(std::string_view text, std::size_t most = kMostQuotedCharacters);

/// printable(), with every part that may be input shortened: what stands before ": found" and behind it, what
/// stands between quotes, and any text without a blank.
std::string message_line(std::string_view message);

}  // namespace testbench
