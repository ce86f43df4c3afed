#include "testbench/run/toml_settings.hpp"

#include <algorithm>

#include "model/config/chip_parameters.hpp"

namespace testbench {
namespace {

/// Groups of keys have shorter names. In a longer one, each key would bring the whole name along.
constexpr std::size_t kLongestGroup = 200;

void collect(const toml::table& table, const std::string& prefix,
             const std::function<bool(const toml::table&)>& is_leaf, std::vector<TomlLeaf>& leaves) {
  for (const auto& [name, node] : table) {
    const std::string key = prefix + std::string(name.str());
    const toml::table* const group = key.size() <= kLongestGroup ? node.as_table() : nullptr;
    if (group != nullptr && !(is_leaf && is_leaf(*group))) {
      collect(*group, key + ".", is_leaf, leaves);
    } else {
      leaves.push_back({key, &node});
    }
  }
}

}  // namespace

std::optional<std::string> scalar_text(const toml::node& node) {
  if (const auto flag = node.value_exact<bool>()) return *flag ? "true" : "false";
  if (const auto integer = node.value_exact<std::int64_t>()) return std::to_string(*integer);
  if (const auto real = node.value_exact<double>()) return model::value_text(*real);
  return node.value_exact<std::string>();
}

std::string found_text(const toml::node& node) {
  if (node.is_table()) return "a table";
  if (node.is_array()) return "an array";
  const std::optional<std::string> text = scalar_text(node);
  return text ? "'" + *text + "'" : "a date or time";
}

std::string line_of(const std::string& file, const toml::node& node) {
  return file + ":" + std::to_string(node.source().begin.line);
}

std::vector<TomlLeaf> leaves_of(const toml::table& table,
                                const std::function<bool(const toml::table&)>& is_leaf) {
  std::vector<TomlLeaf> leaves;
  collect(table, "", is_leaf, leaves);
  const auto place = [](const TomlLeaf& leaf) {
    const toml::source_position& begin = leaf.node->source().begin;
    return std::make_pair(begin.line, begin.column);
  };
  std::stable_sort(leaves.begin(), leaves.end(),
                   [&](const TomlLeaf& a, const TomlLeaf& b) { return place(a) < place(b); });
  return leaves;
}

}  // namespace testbench
