#include "testbench/system/csv.hpp"

namespace testbench {

std::string csv_text(const std::string& text) {
  constexpr const char* kFormulaBegins = "=+-@\t\r";
  constexpr const char* kNeedQuotes = ",\"\r\n";
  const bool is_formula = text.find_first_of(kFormulaBegins) == 0;
  const std::string safe = (is_formula ? "'" : "") + text;
  if (safe.find_first_of(kNeedQuotes) == std::string::npos) return safe;
  std::string quoted = "\"";
  for (const char c : safe) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

}  // namespace testbench
