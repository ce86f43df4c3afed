#pragma once

#include <toml++/toml.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

/// How sweep files and golden grids write the settings of runs. For their readers' sources only.
namespace testbench {

/// A number, a text or a flag as `--set` would be given it; none for anything else.
std::optional<std::string> scalar_text(const toml::node& node);

/// What an error message says of a node: "'3'", "an array".
std::string found_text(const toml::node& node);

/// "sweep.toml:7"
std::string line_of(const std::string& file, const toml::node& node);

/// A key with its dots, and its value.
struct TomlLeaf {
  std::string key;
  const toml::node* node;
};

/// The leaves of a table in the order of the file, which a TOML table does not keep. A table with a name that
/// is longer than any setting's is a leaf, too.
/// @param is_leaf whether a table is a value and not a group of keys; a null function: no table is
std::vector<TomlLeaf> leaves_of(const toml::table& table,
                                const std::function<bool(const toml::table&)>& is_leaf = {});

}  // namespace testbench
