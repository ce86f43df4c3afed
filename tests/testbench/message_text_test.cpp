// What messages quote is printable, on one line and short.

#include "testbench/system/message_text.hpp"

#include <gtest/gtest.h>

#include "testbench/system/error.hpp"

namespace message_text_test {

using testbench::message_line;
using testbench::printable;
using testbench::shortened;

TEST(MessageText, ControlCharactersAndBytesThatAreNotUtf8AreEscaped) {
  EXPECT_EQ(printable("a\nb\tc\rd"), "a\\nb\\tc\\rd");
  EXPECT_EQ(printable(std::string_view("\0\x1b[2J\x7f", 6)), "\\x00\\x1b[2J\\x7f");
  EXPECT_EQ(printable("\xff|\xc3|\xc0\x80|\xed\xa0\x80"), "\\xff|\\xc3|\\xc0\\x80|\\xed\\xa0\\x80");
  EXPECT_EQ(printable("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80") << "above U+10FFFF";
}

TEST(MessageText, OtherTextIsLeftAsItIs) {
  const std::string text = "C:\\a 'b' \xc3\xa9 \xe2\x82\xac \xf0\x9f\x92\xa1";
  EXPECT_EQ(printable(text), text);
  EXPECT_EQ(message_line(text), text);
}

TEST(MessageText, MarksThatWouldChangeTheLineAreEscaped) {
  EXPECT_EQ(printable("\xc2\x85"), "\\xc2\\x85") << "next line";
  EXPECT_EQ(printable("\xe2\x80\xa8"), "\\xe2\\x80\\xa8") << "line separator";
  EXPECT_EQ(printable("\xe2\x80\xae"), "\\xe2\\x80\\xae") << "right-to-left override";
}

TEST(MessageText, ShorteningKeepsBothEndsAndWholeCharacters) {
  EXPECT_EQ(shortened("abcdefghij", 10), "abcdefghij");
  EXPECT_EQ(shortened("abcdefghijk", 10), "abcdef...k");
  std::string euros;
  for (int i = 0; i < 11; ++i) euros += "\xe2\x82\xac";
  EXPECT_EQ(shortened(euros, 10).size(), 7 * 3u + 3);
  EXPECT_EQ(printable(shortened(euros, 10)), shortened(euros, 10));
}

TEST(MessageText, EveryQuotedPartIsShort) {
  const std::string words(5000, 'w');
  std::string blanks;
  while (blanks.size() < 5000) blanks += "it's b' ";
  for (const std::string& input : {words, blanks})
    for (const std::string& message :
         {"--size: found '" + input + "', allowed is WIDTHxHEIGHT", input + ": cannot be read",
          "scene.toml:3: film: found [ " + input + " ]; allowed: one [film] table",
          "a.toml:1: " + input + ": found 3; allowed: none"}) {
      const std::string line = message_line(message);
      const bool is_unmarked = &input != &words && message == input + ": cannot be read";
      EXPECT_LE(line.size(), is_unmarked ? 1000u : 380u) << line;
    }
  const std::string line = message_line("--size: found '" + blanks + "', allowed is WIDTHxHEIGHT");
  EXPECT_EQ(line.rfind("--size: found 'it's", 0), 0u) << line;
  EXPECT_NE(line.find("', allowed is WIDTHxHEIGHT"), std::string::npos) << line;
}

TEST(MessageText, ListsOfAllowedValuesStayWhole) {
  std::string message = "a.toml:1: found the key 'x'; allowed: ";
  while (message.size() < 900) message += "firmware.option, ";
  EXPECT_EQ(message_line(message), message);
}

TEST(MessageText, ErrorsHaveOneLine) {
  EXPECT_STREQ(testbench::InputError("a\nb").what(), "a\\nb");
  EXPECT_STREQ(testbench::RunError("a\nb").what(), "a\\nb");
  const testbench::InputError with_table("a", "1\n2");
  EXPECT_STREQ(with_table.what(), "a");
  EXPECT_EQ(with_table.details(), "1\n2");
}

}  // namespace message_text_test
