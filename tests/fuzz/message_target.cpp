#include <algorithm>
#include <string>

#include "testbench/files/csv.hpp"
#include "testbench/system/message_text.hpp"
#include "tests/fuzz/targets.hpp"

namespace fuzz {
namespace {

void require_one_line(const std::string& text) {
  const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
  if (std::any_of(text.begin(), text.end(), is_control)) fail("a control character in a message");
}

}  // namespace

void read_message(std::string_view input) {
  const std::string text = testbench::printable(input);
  require_one_line(text);
  if (testbench::printable(text) != text) fail("a printable text that changes");
  const std::string line = testbench::message_line(input);
  require_one_line(line);
  constexpr std::size_t kMostBytesOfCharacter = 4;
  if (line.size() > kMostBytesOfCharacter * testbench::kMostMessageCharacters)
    fail("a message that is too long");
  testbench::csv_text(std::string(input));
}

}  // namespace fuzz
