#include "model/config/chip_file.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>

#include "model/config/chip_presets.hpp"

namespace model {
namespace {

constexpr std::string_view kFileEnding = ".toml";

bool ends_with(std::string_view text, std::string_view ending) {
  return text.size() >= ending.size() && text.substr(text.size() - ending.size()) == ending;
}

toml::table parse(const std::string& file, const std::string& text) {
  try {
    return toml::parse(text, file);
  } catch (const toml::parse_error& error) {
    throw ConfigError(file + ":" + std::to_string(error.source().begin.line) +
                      ": not TOML: " + std::string(error.description()));
  }
}

/// Shows an unusable value in an error message.
std::string found_text(const toml::node& node) {
  if (node.is_table()) return "a table";
  if (node.is_array()) return "an array";
  std::ostringstream text;
  text << toml::node_view<const toml::node>(node);
  return text.str();
}

/// Copies the parameters of a TOML file into a chip.
class FileReader {
 public:
  FileReader(std::string file, ChipConfig& config) : file_(std::move(file)), config_(config) {}

  /// @param prefix "" or a group with its dot, such as "pio."
  void read(const toml::table& table, const std::string& prefix) {
    for (const auto& [name, node] : table) {
      const std::string key = prefix + std::string(name.str());
      if (key == "preset") continue;  // read before all others
      if (is_group(key)) {
        read_group(node, key);
      } else {
        read_parameter(node, key);
      }
    }
  }

  std::string line_of(const toml::node& node) const {
    return file_ + ":" + std::to_string(node.source().begin.line);
  }

 private:
  static bool is_group(const std::string& key) {
    const std::vector<ParameterInfo>& table = parameter_table();
    return std::any_of(table.begin(), table.end(), [&](const ParameterInfo& parameter) {
      return parameter.key.compare(0, key.size() + 1, key + ".") == 0;
    });
  }

  void read_group(const toml::node& node, const std::string& key) {
    if (!node.is_table()) {
      throw ConfigError(line_of(node) + ": " + key + ": found " + found_text(node) +
                        "; allowed: a table of parameters");
    }
    read(*node.as_table(), key + ".");
  }

  void read_parameter(const toml::node& node, const std::string& key) {
    const std::string origin = line_of(node);
    const ParameterInfo* parameter = find_parameter(key);
    const bool is_real = parameter && std::holds_alternative<RealRange>(parameter->allowed);
    if (const auto flag = node.value_exact<bool>()) {
      set_parameter_value(config_, key, *flag, origin);
    } else if (const auto integer = node.value_exact<std::int64_t>(); integer && is_real) {
      set_parameter_value(config_, key, static_cast<double>(*integer), origin);
    } else if (integer) {
      set_parameter_value(config_, key, *integer, origin);
    } else if (const auto real = node.value_exact<double>()) {
      set_parameter_value(config_, key, *real, origin);
    } else if (const auto text = node.value_exact<std::string>()) {
      set_parameter_value(config_, key, *text, origin);
    } else {
      set_parameter(config_, key, found_text(node), origin);  // no parameter accepts it
    }
  }

  std::string file_;
  ChipConfig& config_;
};

ChipConfig base_of(const std::string& file, const toml::table& table) {
  const toml::node* node = table.get("preset");
  if (!node) return preset("csx600");
  const std::string line = file + ":" + std::to_string(node->source().begin.line);
  const auto name = node->value_exact<std::string>();
  if (!name) throw ConfigError(line + ": preset: found " + found_text(*node) + "; allowed: a string");
  return preset(*name, line);
}

/// "poly.cycles" of "poly.cycles.fp64_add"
std::string_view group_of(std::string_view key) {
  return key.substr(0, key.rfind('.'));
}

std::string toml_value(const ParameterValue& value) {
  const std::string text = value_text(value);
  return std::holds_alternative<std::string>(value) ? '"' + text + '"' : text;
}

}  // namespace

std::string read_chip_file(const std::string& file) {
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored)) {
    throw ConfigError(file + ": found a directory; allowed: a readable TOML file");
  }
  std::ifstream stream(file, std::ios::binary);
  if (!stream) {
    throw ConfigError(file + ": cannot be read (" + std::generic_category().message(errno) +
                      "); allowed: a readable TOML file");
  }
  std::ostringstream content;
  content << stream.rdbuf();
  return content.str();
}

ChipConfig load_chip(std::string_view preset_or_file,
                     const std::function<std::string(const std::string& file)>& read) {
  if (!ends_with(preset_or_file, kFileEnding)) {
    if (find_preset(preset_or_file)) return preset(preset_or_file);
    std::string list;
    for (const std::string& name : preset_names()) list += name + ", ";
    throw ConfigError("unknown preset '" + std::string(preset_or_file) + "'; allowed: " + list +
                      "or a file whose name ends in .toml");
  }
  const std::string file(preset_or_file);
  const toml::table table = parse(file, read(file));
  ChipConfig config = base_of(file, table);
  FileReader(file, config).read(table, "");
  validate(config, file);
  return config;
}

std::string effective_toml(const ChipConfig& config) {
  std::ostringstream text;
  text << "preset = \"" << config.preset << "\"\n";
  std::string_view group;
  for (const ParameterInfo& parameter : parameter_table()) {
    const std::string_view key = parameter.key;
    if (group_of(key) != group) {
      group = group_of(key);
      text << "\n[" << group << "]\n";
    }
    text << key.substr(group.size() + 1) << " = " << toml_value(parameter.read(config));
    text << (parameter.unit == "-" ? "" : "  # " + parameter.unit) << '\n';
  }
  return text.str();
}

}  // namespace model
