#pragma once

#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <initializer_list>
#include <limits>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "testbench/scene/mesh.hpp"
#include "testbench/scene/scene.hpp"
#include "testbench/system/error.hpp"

namespace testbench {

inline constexpr double kLargestDouble = std::numeric_limits<double>::max();

/// Throws InputError. `where` is a file, or a file and a line.
[[noreturn]] inline void fail_at_key(const std::string& where, std::string_view key, std::string_view found,
                                     std::string_view allowed) {
  std::ostringstream message;
  message << where << ": " << key << ": found " << found << "; allowed: " << allowed;
  std::string line = message.str();
  std::replace(line.begin(), line.end(), '\n', ' ');
  throw InputError(line);
}

inline std::string joined(const std::vector<const char*>& words) {
  std::string result;
  for (const char* word : words) result += (result.empty() ? "" : ", ") + std::string(word);
  return result;
}

/// One table of a scene.toml, with typed and checked access to its keys.
class TableReader {
 public:
  TableReader(std::string file, std::string name, const toml::table& table)
      : file_(std::move(file)), name_(std::move(name)), table_(table) {}

  void require_only(const std::vector<const char*>& allowed) const {
    for (const auto& [key, node] : table_) {
      const auto matches = [&key_text = key](const char* word) { return key_text.str() == word; };
      if (std::none_of(allowed.begin(), allowed.end(), matches)) {
        fail_at_key(where(node), full_key(key.str()), "an unknown key", joined(allowed));
      }
    }
  }

  bool has(const char* key) const { return table_.contains(key); }

  /// The number of the group of keys, from 0 on, that the table holds. Fails unless it holds one of them
  /// completely and no key of another.
  std::size_t group_of(std::initializer_list<std::initializer_list<const char*>> groups) const {
    std::string found;
    std::string allowed;
    std::size_t begun = 0;
    std::size_t whole = groups.size();
    std::size_t number = 0;
    for (const auto& group : groups) {
      std::size_t keys = 0;
      for (const char* key : group) {
        if (!has(key)) continue;
        ++keys;
        found += (found.empty() ? "" : " and ") + std::string(key);
      }
      begun += keys > 0;
      if (keys == group.size()) whole = number;
      allowed += (number++ == 0 ? "either " : " or ") + joined(group);
    }
    if (begun == 1 && whole < groups.size()) return whole;
    fail_at_key(where(table_), name_, found.empty() ? "neither form" : found, allowed);
  }

  /// A number in the open interval (low, high).
  double number_between(const char* key, double low, double high) const {
    const toml::node& node = require(key);
    const std::optional<double> value = finite(node);
    if (!value || *value <= low || *value >= high) {
      std::ostringstream allowed;
      allowed << "a number greater than " << low;
      if (high < kLargestDouble) allowed << " and less than " << high;
      fail_at_key(where(node), full_key(key), text_of(node), allowed.str());
    }
    return *value;
  }

  /// A number in the closed interval [least, most]. @param allowed says so in the message
  double number_within(const char* key, double least, double most, const std::string& allowed) const {
    const toml::node& node = require(key);
    const std::optional<double> value = finite(node);
    if (!value || !(*value >= least && *value <= most))
      fail_at_key(where(node), full_key(key), text_of(node), allowed);
    return *value;
  }

  /// A number of at most kMaxCoordinate.
  double number(const char* key) const {
    return number_within(key, -kMaxCoordinate, kMaxCoordinate, "a finite number of at most 1e100");
  }

  bool flag(const char* key) const {
    const toml::node& node = require(key);
    const std::optional<bool> value = node.value_exact<bool>();
    if (!value) fail_at_key(where(node), full_key(key), text_of(node), "true or false");
    return *value;
  }

  /// The place of a text among the allowed ones.
  std::size_t choice(const char* key, const std::vector<const char*>& allowed) const {
    const toml::node& node = require(key);
    const std::optional<std::string> value = node.value_exact<std::string>();
    for (std::size_t i = 0; value && i < allowed.size(); ++i)
      if (*value == allowed[i]) return i;
    fail_at_key(where(node), full_key(key), text_of(node), joined(allowed));
  }

  /// Two finite numbers.
  glm::dvec2 pair(const char* key) const {
    const toml::node& node = require(key);
    const toml::array* const array = node.as_array();
    const bool is_pair = array != nullptr && array->size() == 2;
    const std::optional<double> first = is_pair ? finite((*array)[0]) : std::nullopt;
    const std::optional<double> second = is_pair ? finite((*array)[1]) : std::nullopt;
    if (!first || !second)
      fail_at_key(where(node), full_key(key), text_of(node), "two finite numbers [u, v]");
    return {*first, *second};
  }

  bool is_table(const char* key) const { return require(key).is_table(); }
  bool is_number(const char* key) const { return require(key).is_number(); }

  int whole_number(const char* key, int least, int most) const {
    const toml::node& node = require(key);
    const std::optional<std::int64_t> value = node.value_exact<std::int64_t>();
    if (!value || *value < least || *value > most)
      fail_at_key(where(node), full_key(key), text_of(node),
                  "a whole number from " + std::to_string(least) + " to " + std::to_string(most));
    return static_cast<int>(*value);
  }

  int pixels(const char* key) const {
    return has(key) ? whole_number(key, 1, kMaxFilmSide) : kDefaultFilmSide;
  }

  glm::dvec3 vector(const char* key) const {
    const toml::node& node = require(key);
    const toml::array* array = node.as_array();
    glm::dvec3 result(0.0);
    bool good = array != nullptr && array->size() == 3;
    for (std::size_t axis = 0; good && axis < 3; ++axis) {
      const std::optional<double> value = finite((*array)[axis]);
      good = value && std::abs(*value) <= kMaxCoordinate;
      if (good) result[static_cast<int>(axis)] = *value;
    }
    if (!good)
      fail_at_key(where(node), full_key(key), text_of(node),
                  "three finite numbers [x, y, z] of at most 1e100");
    return result;
  }

  glm::dvec3 vector_or(const char* key, const glm::dvec3& otherwise) const {
    return has(key) ? vector(key) : otherwise;
  }

  /// Three numbers from 0 to `high`. @param allowed says so in the message
  glm::dvec3 colour(const char* key, double high, const std::string& allowed) const {
    const glm::dvec3 result = vector(key);
    for (int channel = 0; channel < 3; ++channel)
      if (!(result[channel] >= 0.0 && result[channel] <= high)) fail_at(key, text_of(key), allowed);
    return result;
  }

  /// The table that the key holds.
  TableReader table(const char* key) const {
    const toml::node& node = require(key);
    if (!node.is_table())
      fail_at_key(where(node), full_key(key), text_of(node), "a table {key = value, ...}");
    return TableReader(file_, full_key(key), *node.as_table());
  }

  /// File and line of a key, for messages.
  std::string where_is(const char* key) const { return where(require(key)); }

  std::string text(const char* key) const {
    const toml::node& node = require(key);
    const std::optional<std::string> value = node.value_exact<std::string>();
    if (!value || value->empty())
      fail_at_key(where(node), full_key(key), text_of(node), "a file name in quotes");
    return *value;
  }

  /// Fails at the line of `key`, or at the line of the table if it has no such key.
  [[noreturn]] void fail_at(const char* key, std::string_view found, std::string_view allowed) const {
    const toml::node* node = table_.get(key);
    fail_at_key(node != nullptr ? where(*node) : where(table_), full_key(key), found, allowed);
  }

  std::string text_of(const char* key) const { return text_of(require(key)); }

 private:
  static std::optional<double> finite(const toml::node& node) {
    if (!node.is_number()) return std::nullopt;
    const std::optional<double> value = node.value<double>();
    if (!value || !std::isfinite(*value)) return std::nullopt;
    return value;
  }

  static std::string text_of(const toml::node& node) {
    std::ostringstream text;
    text << toml::toml_formatter{node};
    return text.str();
  }

  const toml::node& require(const char* key) const {
    const toml::node* node = table_.get(key);
    if (node == nullptr) fail_at_key(where(table_), full_key(key), "none", "this key is required");
    return *node;
  }

  std::string where(const toml::node& node) const {
    const auto line = node.source().begin.line;
    return line > 0 ? file_ + ":" + std::to_string(line) : file_;
  }

  std::string full_key(std::string_view key) const {
    return name_.empty() ? std::string(key) : name_ + "." + std::string(key);
  }

  std::string file_;
  std::string name_;
  const toml::table& table_;
};

}  // namespace testbench
