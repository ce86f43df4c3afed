#include "testbench/files/csv.hpp"

namespace testbench {
namespace {

std::string without_formula(const std::string& text) {
  const bool is_formula = text.find_first_of("=+-@\t\r") == 0;
  return (is_formula ? "'" : "") + text;
}

}  // namespace

std::string csv_quoted(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : without_formula(text)) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

std::string csv_text(const std::string& text) {
  const bool needs_quotes = text.find_first_of(",\"\r\n") != std::string::npos;
  return needs_quotes ? csv_quoted(text) : without_formula(text);
}

}  // namespace testbench
