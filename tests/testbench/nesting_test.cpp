#include "testbench/system/nesting.hpp"

#include <gtest/gtest.h>

#include "tests/support/input_error.hpp"

namespace nesting_test {

using test_support::expect_input_error;
using testbench::kMostNesting;
using testbench::require_shallow_json;
using testbench::require_shallow_toml;

std::string times(std::size_t count, const std::string& text) {
  std::string all;
  for (std::size_t i = 0; i < count; ++i) all += text;
  return all;
}

TEST(Nesting, JsonOfTheLimitPassesAndOneLevelMoreDoesNot) {
  for (const auto& [open, close] : {std::pair<std::string, std::string>("[", "]"), {"{\"k\":", "}"}}) {
    const auto nested = [&, o = open, c = close](std::size_t levels) {
      return times(levels, o) + "1" + times(levels, c);
    };
    EXPECT_NO_THROW(require_shallow_json(nested(kMostNesting), "run.json"));
    expect_input_error([&] { require_shallow_json("\n" + nested(kMostNesting + 1), "run.json"); },
                       {"run.json:2: ", "more than 64 deep"});
  }
}

TEST(Nesting, SiblingsAreNoLevels) {
  EXPECT_NO_THROW(require_shallow_json("[" + times(1000, "[{}],") + "[]]", ""));
  EXPECT_NO_THROW(require_shallow_toml(times(1000, "[group.of]\na.b = [[1.5], {c.d = 2.5}]\n"), ""));
  EXPECT_NO_THROW(require_shallow_toml("a = [" + times(1000, "0.5, ") + "]", ""));
  EXPECT_NO_THROW(require_shallow_toml("a = [\n" + times(1000, "0.5\n,") + "]", ""));
}

TEST(Nesting, BracketsInStringsAndCommentsAreNoLevels) {
  const std::string many = times(1000, "[");
  EXPECT_NO_THROW(require_shallow_json("[\"" + many + "\\\"" + many + "\"]", ""));
  EXPECT_NO_THROW(require_shallow_toml("a = \"" + many + "\\\"" + many + "\"", ""));
  EXPECT_NO_THROW(require_shallow_toml("a = '" + many + "\\' # " + many + "\n", ""));
  EXPECT_NO_THROW(require_shallow_toml("a = \"\"\"" + many + "\n\"\n" + many + "\"\"\"\"\"\nb = 1", ""));
  EXPECT_NO_THROW(require_shallow_toml("a = '''" + many + "'\n" + many + "'''", ""));
  EXPECT_NO_THROW(require_shallow_toml("# " + many + times(1000, ".") + "\na = 1", ""));
}

TEST(Nesting, WhatFollowsAStringCounts) {
  const std::string deep = times(kMostNesting + 1, "[");
  for (const char* const before : {"a = \"x\"\nb = ", "a = '\\'\nb = ", "a = \"\"\"x\n\"\"\"\"\nb = ",
                                   "a = ''\nb = ", "# '\nb = ", "a = \"\"\nb = "})
    expect_input_error([&] { require_shallow_toml(before + deep, "c.toml"); }, {"c.toml:", "nested"});
  expect_input_error([&] { require_shallow_json("[\"\\\\\"," + deep, "r"); }, {"r:1: "});
}

TEST(Nesting, PartsOfTomlKeysAreLevels) {
  const std::string parts = times(kMostNesting, ".a");
  EXPECT_NO_THROW(require_shallow_toml("a" + parts.substr(2) + " = 1", ""));
  for (const std::string& text : {"\na" + parts + ".a = 1", "\n[a" + parts + "]",
                                  "\na" + times(40, ".a") + " = {a" + times(40, ".a") + " = 1}"})
    expect_input_error([&] { require_shallow_toml(text, "c.toml"); }, {"c.toml:2: ", "more than 64 deep"});
}

TEST(Nesting, MillionsOfBracketsTakeLinearTime) {
  EXPECT_NO_THROW(require_shallow_json(times(2'000'000, "[]") + times(2'000'000, "]"), ""));
  expect_input_error([] { require_shallow_json(times(4'000'000, "["), "r"); }, {"r:1"});
}

}  // namespace nesting_test
