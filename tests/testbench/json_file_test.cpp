#include "testbench/statistics/json_file.hpp"

#include <gtest/gtest.h>

#include <string>

#include "tests/support/input_error.hpp"

namespace json_file_test {

nlohmann::ordered_json parse(const std::string& text) {
  return testbench::parse_json_object(text, "a.json", "a test's file");
}
std::string refusal(const std::string& text) {
  return test_support::input_error_of([&] { parse(text); });
}

std::string members(int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += (i == 0 ? "{\"" : ",\"") + std::to_string(i) + "\":0";
  return text + "}";
}

// The library looks through all members of an object for each new one.
TEST(JsonFile, ObjectsHaveAsManyMembersAsCanBeReadQuickly) {
  EXPECT_EQ(parse("{\"a\":" + members(10000) + ",\"b\":" + members(10000) + "}")["b"].size(), 10000u);
  EXPECT_EQ(refusal("{\"a\":[" + members(10001) + "]}"),
            "a.json: found an object of more than 10000 members; allowed: at most so many");
}

// Flattened, each value brings along the keys that it lies in: 100 KB of key above 50,000 values were 5 GB.
TEST(JsonFile, PathsToValuesAreShort) {
  const std::string half(255, 'k');
  EXPECT_EQ(parse("{\"" + half + "\":{\"" + half + "\":1}}").size(), 1u);
  EXPECT_EQ(refusal("{\"" + half + "\":{\"" + half + "k\":1}}"),
            "a.json: found a key of 513 characters, with those that it lies in; allowed: at most 512");
  EXPECT_EQ(refusal("{\"a\":[{\"name\":\"" + half + half + "\",\"b\":1}]}"),
            "a.json: found a key of 513 characters, with those that it lies in; allowed: at most 512");
}

}  // namespace json_file_test
