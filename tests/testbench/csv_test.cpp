#include "testbench/files/csv.hpp"

#include <gtest/gtest.h>

namespace csv_test {

using testbench::csv_text;

TEST(Csv, PlainTextStaysAsItIs) {
  for (const char* const text : {"", "refill", "a=b", "5-3", "chip.pio.pes", "two words"})
    EXPECT_EQ(csv_text(text), text);
}

TEST(Csv, SeparatorsAreQuoted) {
  EXPECT_EQ(csv_text("a,b"), "\"a,b\"");
  EXPECT_EQ(csv_text("say \"so\""), "\"say \"\"so\"\"\"");
  EXPECT_EQ(csv_text("a\rb"), "\"a\rb\"");
  EXPECT_EQ(csv_text("a\nb"), "\"a\nb\"");
}

TEST(Csv, NoTextBeginsAsAFormula) {
  EXPECT_EQ(csv_text("=1+1"), "'=1+1");
  EXPECT_EQ(csv_text("+scene"), "'+scene");
  EXPECT_EQ(csv_text("-scene"), "'-scene");
  EXPECT_EQ(csv_text("@sum"), "'@sum");
  EXPECT_EQ(csv_text("\r=1"), "\"'\r=1\"");
  EXPECT_EQ(csv_text("=HYPERLINK(\"x\",1)"), "\"'=HYPERLINK(\"\"x\"\",1)\"");
}

}  // namespace csv_test
