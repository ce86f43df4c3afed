#include "testbench/statistics/statistics_difference.hpp"

#include <fnmatch.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <unordered_map>

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;
using Value = std::optional<Json>;

bool matches(const std::string& glob, const std::string& key) {
  return fnmatch(glob.c_str(), key.c_str(), 0) == 0;
}

bool is_ignored(const std::string& key, const ComparisonRules& rules) {
  return std::any_of(rules.ignore.begin(), rules.ignore.end(),
                     [&](const std::string& glob) { return matches(glob, key); });
}

double tolerance(const std::string& key, const ComparisonRules& rules) {
  double relative = 0;
  for (const Tolerance& of : rules.tolerances)
    if (matches(of.glob, key)) relative = of.relative;
  return relative;
}

bool differ(const Difference& pair, const ComparisonRules& rules) {
  if (pair.a && pair.b && *pair.a == *pair.b) return false;
  const std::optional<double> relative = pair.relative();
  return !relative || std::abs(*relative) > tolerance(pair.key, rules);
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
  return largest > 0 ? (second - first) / largest : 0;
}

Comparison compare(const FlatStatistics& a, const FlatStatistics& b, const ComparisonRules& rules) {
  const std::unordered_map<std::string, Json> in_a(a.begin(), a.end());
  const std::unordered_map<std::string, Json> in_b(b.begin(), b.end());
  Comparison comparison;
  for (const std::string& key : union_of_keys(a, b, in_a)) {
    if (is_ignored(key, rules)) continue;
    ++comparison.compared;
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
