#include "testbench/sampling/time_budget.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace testbench {
namespace {

/// What predictions may be wrong by: passes end when their longest paths do.
constexpr double kSafety = 0.95;
constexpr double kSpareFirstPasses = 0.25;

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
  if (passes_++ == 0) {
    first_paths_ = paths;
    first_seconds_ = seconds;
  }
  if (paths < largest_paths_) return;
  largest_paths_ = paths;
  seconds_a_path_ = seconds / paths;
}

double PassTimes::most_paths(double seconds) const {
  const double each_pass = passes_ > 1 ? std::max(0.0, first_seconds_ - first_paths_ * seconds_a_path_) : 0;
  const double usable = kSafety * seconds - each_pass - kSpareFirstPasses * first_seconds_;
  return std::max(0.0, usable / seconds_a_path_);
}

}  // namespace testbench
