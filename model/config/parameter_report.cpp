#include "model/config/parameter_report.hpp"

#include <algorithm>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>

#include "model/config/chip_presets.hpp"

namespace model {
namespace {

/// A parameter's value in one chip, and where it comes from.
struct Provenance {
  std::string_view confidence;
  std::string_view preset_reason;  ///< empty unless the preset gives the value
};

Provenance provenance(const ChipConfig& config, const ParameterInfo& parameter) {
  const ParameterValue value = parameter.read(config);
  if (const Preset* preset = find_preset(config.preset)) {
    for (const PresetOverride& set : preset->overrides) {
      if (set.key != parameter.key) continue;
      if (set.value != value_text(value)) return {"user", {}};
      return {confidence_name(set.confidence), set.why};
    }
  }
  if (value != parameter.default_value) return {"user", {}};
  return {confidence_name(parameter.confidence), {}};
}

using Row = std::vector<std::string>;

/// Left-justified columns two blanks apart; the last is not padded.
void write_rows(std::ostream& out, const std::vector<Row>& rows) {
  std::vector<std::size_t> widths(rows.front().size(), 0);
  for (const Row& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  for (const Row& row : rows) {
    for (std::size_t i = 0; i + 1 < row.size(); ++i)
      out << std::left << std::setw(int(widths[i]) + 2) << row[i];
    out << row.back() << '\n';
  }
}

nlohmann::ordered_json json_value(const ParameterValue& value) {
  return std::visit([](const auto& held) { return nlohmann::ordered_json(held); }, value);
}

}  // namespace

std::string parameter_text_report(const ChipConfig& config) {
  std::vector<Row> rows = {{"key", "value", "unit", "confidence", "meaning"}};
  for (const ParameterInfo& parameter : parameter_table()) {
    const auto [confidence, reason] = provenance(config, parameter);
    std::string meaning = parameter.meaning;
    if (!reason.empty()) meaning += " | " + config.preset + ": " + std::string(reason);
    rows.push_back({parameter.key, value_text(parameter.read(config)), parameter.unit,
                    std::string(confidence), meaning});
  }
  std::ostringstream out;
  write_rows(out, rows);
  out << "\nsources\n";
  std::vector<Row> sources;
  for (const ParameterSource& source : parameter_sources()) {
    sources.push_back({std::string(source.id), std::string(source.title)});
  }
  write_rows(out, sources);
  return out.str();
}

std::string parameter_json_report(const ChipConfig& config) {
  nlohmann::ordered_json report = nlohmann::ordered_json::array();
  for (const ParameterInfo& parameter : parameter_table()) {
    const auto [confidence, reason] = provenance(config, parameter);
    nlohmann::ordered_json entry;
    entry["key"] = parameter.key;
    entry["value"] = json_value(parameter.read(config));
    entry["unit"] = parameter.unit;
    entry["confidence"] = confidence;
    entry["meaning"] = parameter.meaning;
    entry["default"] = json_value(parameter.default_value);
    entry["allowed"] = allowed_text(parameter);
    if (!reason.empty()) entry["preset_reason"] = reason;
    report.push_back(std::move(entry));
  }
  return report.dump(2) + "\n";
}

std::string parameter_markdown(const ChipConfig& config) {
  std::ostringstream out;
  out << "| key | value | unit | confidence | allowed | meaning |\n|---|---|---|---|---|---|\n";
  for (const ParameterInfo& parameter : parameter_table())
    out << "| `" << parameter.key << "` | " << value_text(parameter.read(config)) << " | " << parameter.unit
        << " | " << provenance(config, parameter).confidence << " | " << allowed_text(parameter) << " | "
        << parameter.meaning << " |\n";
  out << "\n| source | title |\n|---|---|\n";
  for (const ParameterSource& source : parameter_sources())
    out << "| " << source.id << " | " << source.title << " |\n";
  return out.str();
}

std::string preset_text_report() {
  std::ostringstream out;
  for (const Preset& preset : preset_table()) {
    out << preset.name << ": " << preset.summary << '\n';
    std::vector<Row> rows;
    for (const PresetOverride& set : preset.overrides) {
      rows.push_back({"  " + std::string(set.key), std::string(set.value),
                      std::string(confidence_name(set.confidence)), std::string(set.why)});
    }
    if (!rows.empty()) write_rows(out, rows);
  }
  return out.str();
}

}  // namespace model
