#include "testbench/statistics/statistics_difference.hpp"

#include <fnmatch.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <unordered_map>

#include "testbench/statistics/counters.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;
using Value = std::optional<Json>;

bool matches(const std::string& glob, const std::string& key) {
  return fnmatch(glob.c_str(), key.c_str(), 0) == 0;
}

bool is_ignored(const std::string& key, const ComparisonRules& rules) {
  const Counter* const counter = find_counter(key);
  if (counter != nullptr && counter->kind == CounterKind::told) return true;
  return std::any_of(rules.ignore.begin(), rules.ignore.end(),
                     [&](const std::string& glob) { return matches(glob, key); });
}

double tolerance(const std::string& key, const ComparisonRules& rules) {
  double relative = 0;
  for (const Tolerance& of : rules.tolerances)
    if (matches(of.glob, key)) relative = of.relative;
  return relative;
}

double absolute_tolerance(const std::string& key, const ComparisonRules& rules) {
  double distance = 0;
  for (const AbsoluteTolerance& of : rules.absolute)
    if (matches(of.glob, key)) distance = of.distance;
  return distance;
}

/// The sign and magnitude of b - a for integers of 64 bits, exact. nlohmann::json and double would round
/// them.
long double integer_distance(const Json& a, const Json& b) {
  const auto negative = [](const Json& json) { return !json.is_number_unsigned() && json < 0; };
  const auto bits = [&](const Json& json) {
    return negative(json) ? std::uint64_t(json.get<std::int64_t>()) : json.get<std::uint64_t>();
  };
  const bool b_is_larger = negative(a) != negative(b) ? negative(a) : bits(b) > bits(a);
  const std::uint64_t distance = b_is_larger ? bits(b) - bits(a) : bits(a) - bits(b);
  return b_is_larger ? (long double)(distance) : -(long double)(distance);
}

/// b - a of two numbers; exact for integers, which the 64 bits of a long double's mantissa hold.
long double distance_of(const Json& a, const Json& b) {
  static_assert(std::numeric_limits<long double>::digits >= 64);
  if (a.is_number_integer() && b.is_number_integer()) return integer_distance(a, b);
  const auto value = [](const Json& json) -> long double {
    if (json.is_number_unsigned()) return (long double)(json.get<std::uint64_t>());
    if (json.is_number_integer()) return (long double)(json.get<std::int64_t>());
    return json.get<double>();
  };
  return value(b) - value(a);
}

bool differ(const Difference& pair, const ComparisonRules& rules) {
  if (!pair.a || !pair.b) return true;
  if (!pair.a->is_number() || !pair.b->is_number()) {
    if (pair.key == "scene" && pair.a->is_string() && pair.b->is_string())
      return scene_name_of(pair.a->get<std::string>()) != scene_name_of(pair.b->get<std::string>());
    return *pair.a != *pair.b;
  }
  const long double distance = distance_of(*pair.a, *pair.b);
  if (distance == 0) return false;
  return !(std::abs(*pair.relative()) <= tolerance(pair.key, rules)) &&
         !(std::abs(distance) <= absolute_tolerance(pair.key, rules));
}

/// Keys of `b` that `a` lacks follow the key that they follow in `b`.
std::vector<std::string> union_of_keys(const FlatStatistics& a, const FlatStatistics& b,
                                       const std::unordered_map<std::string, Json>& in_a) {
  std::unordered_map<std::string, std::vector<std::string>> behind;
  std::string last;
  for (const auto& [key, value] : b) {
    if (in_a.count(key) == 0) {
      behind[last].push_back(key);
    } else {
      last = key;
    }
  }
  std::vector<std::string> keys = behind[""];
  for (const auto& [key, value] : a) {
    keys.push_back(key);
    for (const std::string& more : behind[key]) keys.push_back(more);
  }
  return keys;
}

Value find(const std::unordered_map<std::string, Json>& values, const std::string& key) {
  const auto found = values.find(key);
  return found == values.end() ? Value() : Value(found->second);
}

std::string shortened(const Value& value) {
  constexpr std::size_t kLongest = 24;
  const std::string text = value ? value_of(*value) : "missing";
  return text.size() <= kLongest ? text : text.substr(0, kLongest - 3) + "...";
}

}  // namespace

std::optional<double> Difference::relative() const {
  if (!a || !b || !a->is_number() || !b->is_number()) return std::nullopt;
  const double first = a->get<double>();
  const double second = b->get<double>();
  const double largest = std::max(std::abs(first), std::abs(second));
  return largest > 0 ? double(distance_of(*a, *b)) / largest : 0;
}

std::string scene_name_of(const std::string& path) {
  std::filesystem::path name = std::filesystem::path(path).lexically_normal();
  if (name.filename() == "scene.toml") name = name.parent_path();
  if (!name.has_filename()) name = name.parent_path();
  return name.filename().string();
}

Comparison compare(const FlatStatistics& a, const FlatStatistics& b, const ComparisonRules& rules) {
  const std::unordered_map<std::string, Json> in_a(a.begin(), a.end());
  const std::unordered_map<std::string, Json> in_b(b.begin(), b.end());
  Comparison comparison;
  for (const std::string& key : union_of_keys(a, b, in_a)) {
    if (is_ignored(key, rules)) continue;
    comparison.keys.push_back(key);
    const Difference pair{key, find(in_a, key), find(in_b, key)};
    if (differ(pair, rules)) comparison.differences.push_back(pair);
  }
  return comparison;
}

std::string difference_text(const std::vector<Difference>& differences) {
  std::size_t width = 0;
  for (const Difference& of : differences) width = std::max(width, name_of(of.key).size());
  std::string text;
  std::string group;
  for (const Difference& of : grouped(differences)) {
    if (group_of(of.key) != group) text += (group = group_of(of.key)) + '\n';
    char relative[32] = "";
    if (of.relative()) std::snprintf(relative, sizeof(relative), "%+.4g %%", 100 * *of.relative());
    char line[512];
    std::snprintf(line, sizeof(line), "  %-*s  %24s  %24s  %12s  %s", int(width), name_of(of.key).c_str(),
                  shortened(of.a).c_str(), shortened(of.b).c_str(), relative, unit_of(of.key).c_str());
    text += line;
    text.erase(text.find_last_not_of(' ') + 1);
    text += '\n';
  }
  return text;
}

}  // namespace testbench
