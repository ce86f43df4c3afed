#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <string>

namespace testbench {

/// For an option whose values have names: turns a name into its value, and answers anything else with the
/// names that are allowed. (CLI11's own transformer lists its table of names and numbers, one a line.)
template <class T>
CLI::Validator named_values(const std::map<std::string, T>& values) {
  std::string names;
  for (const auto& [name, value] : values) names += (names.empty() ? "" : ", ") + name;
  CLI::Validator validator("{" + names + "}");
  validator.operation([values, names](std::string& text) -> std::string {
    const auto found = values.find(text);
    if (found == values.end()) return "found '" + text + "', allowed is one of " + names;
    text = std::to_string(static_cast<long>(found->second));
    return "";
  });
  return validator;
}

}  // namespace testbench
