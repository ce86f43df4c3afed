#include "testbench/sampling/time_budget.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace testbench {
namespace {

/// What predictions may be wrong by: passes end when their longest paths do.
constexpr double kSafety = 0.95;
constexpr double kSpareFirstPasses = 0.5;

constexpr std::pair<const char*, double> kUnits[] = {{"us", 1e-6}, {"ms", 1e-3}, {"s", 1}, {"min", 60}};

bool begins_as_number(const std::string& text) {
  return !text.empty() && (text[0] == '.' || (text[0] >= '0' && text[0] <= '9')) &&
         text.find_first_of("xX") == std::string::npos;
}

}  // namespace

std::optional<double> parse_duration(const std::string& text) {
  if (!begins_as_number(text)) return std::nullopt;
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  while (*end == ' ') ++end;
  for (const auto& [unit, seconds] : kUnits)
    if (std::string(end) == unit && number * seconds > 0 && std::isfinite(number * seconds))
      return number * seconds;
  return std::nullopt;
}

std::string allowed_duration() {
  return "a number above 0 and a unit, us, ms, s or min: 500ms";
}

void PassTimes::add(double paths, double seconds) {
  passes_.push_back({paths, seconds});
}

double PassTimes::most_paths(double seconds) const {
  const Pass& largest = *std::max_element(passes_.begin(), passes_.end(),
                                          [](const Pass& a, const Pass& b) { return a.paths < b.paths; });
  const double seconds_a_path = largest.seconds / largest.paths;
  double each_pass = 0;
  for (const Pass& pass : passes_)
    each_pass = std::max(each_pass, pass.seconds - pass.paths * seconds_a_path);
  const double usable = kSafety * seconds - each_pass - kSpareFirstPasses * passes_.front().seconds;
  return std::max(0.0, usable / seconds_a_path);
}

}  // namespace testbench
