#include "testbench/system/json_nesting.hpp"

#include <gtest/gtest.h>

#include "tests/support/input_error.hpp"

namespace json_nesting_test {

using testbench::kMaxJsonNesting;
using testbench::require_shallow_json;

std::string nested(std::size_t depth) {
  return std::string(depth, '[') + std::string(depth, ']');
}

TEST(JsonNesting, AllowsAsManyLevelsAsItSays) {
  EXPECT_NO_THROW(require_shallow_json(nested(kMaxJsonNesting), "a.json"));
  test_support::expect_input_error([] { require_shallow_json(nested(kMaxJsonNesting + 1), "a.json"); },
                                   {"a.json", "byte 128", "allowed: 128 levels"});
  test_support::expect_input_error(
      [] {
        std::string text;
        for (int i = 0; i < 1000000; ++i) text += "{\"a\":";
        require_shallow_json(text, "a.json");
      },
      {"a.json"});
}

TEST(JsonNesting, CountsLevelsOnlyWhereTheyLieWithinEachOther) {
  std::string many = "[";
  for (int i = 0; i < 1000; ++i) many += "[],{},";
  EXPECT_NO_THROW(require_shallow_json(many + "0]", "a.json"));
}

TEST(JsonNesting, TextIsNotNesting) {
  EXPECT_NO_THROW(require_shallow_json("\"" + std::string(1000, '[') + "\"", "a.json"));
  EXPECT_NO_THROW(require_shallow_json("\"\\\"" + std::string(1000, '{') + "\"", "a.json"));
  // The quotation mark behind two backslashes ends the text.
  EXPECT_THROW(require_shallow_json("\"\\\\\"" + std::string(1000, '['), "a.json"), testbench::InputError);
}

}  // namespace json_nesting_test
