#pragma once

#include <CLI/CLI.hpp>
#include <charconv>
#include <map>
#include <string>
#include <vector>

namespace testbench {

/// Makes an option take a value of an enumeration by its name, and answer any other text with the names.
/// Help and completion show them in braces. (CLI11's own sets list names and numbers, one a line.)
template <class T>
CLI::Option* one_of(CLI::Option* option, const std::map<std::string, T>& values) {
  std::string names;
  for (const auto& [name, value] : values) names += (names.empty() ? "" : ", ") + name;
  const auto to_number = [values, names](std::string& text) -> std::string {
    const auto found = values.find(text);
    if (found == values.end()) return "found '" + text + "', allowed is one of " + names;
    text = std::to_string(static_cast<long>(found->second));
    return "";
  };
  return option->transform(CLI::Validator(to_number, ""))->type_name("{" + names + "}");
}

/// Makes an option take an integer of a range, and answer any other text with the range.
inline CLI::Option* in_range(CLI::Option* option, int low, int high) {
  const auto error_of = [low, high](const std::string& text) -> std::string {
    int number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    const bool is_number = error == std::errc() && end == text.data() + text.size();
    if (is_number && number >= low && number <= high) return "";
    return "found '" + text + "', allowed is an integer from " + std::to_string(low) + " to " +
           std::to_string(high);
  };
  return option->check(error_of, "")->type_name(std::to_string(low) + ".." + std::to_string(high));
}

}  // namespace testbench
