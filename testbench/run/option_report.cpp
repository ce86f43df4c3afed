#include "testbench/run/option_report.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <vector>

#include "firmware/path_tracer/program/program_options.hpp"

namespace testbench {
namespace {

using path_tracer::ProgramOption;

std::string key_of_option(const ProgramOption& option) {
  return "firmware." + option.name;
}

/// "quantised8, which ...; render: as many as fit"
std::string meaning_and_choice(const ProgramOption& option) {
  return option.meaning + (option.chosen.empty() ? "" : "; `csx600 render` chooses: " + option.chosen);
}

}  // namespace

std::string option_text_report() {
  using Row = std::array<std::string, 5>;
  std::vector<Row> rows = {{"key", "default", "unit", "allowed", "meaning"}};
  for (const ProgramOption& option : path_tracer::program_options())
    rows.push_back({key_of_option(option), path_tracer::value_text(option.default_value), option.unit,
                    allowed_text(option), meaning_and_choice(option)});
  std::string text;
  for (const Row& row : rows) {
    for (std::size_t i = 0; i + 1 < row.size(); ++i) {
      std::size_t width = 0;
      for (const Row& other : rows) width = std::max(width, other[i].size());
      text += row[i] + std::string(width + 2 - row[i].size(), ' ');
    }
    text += row.back() + '\n';
  }
  return text;
}

nlohmann::ordered_json option_json_report() {
  nlohmann::ordered_json report = nlohmann::ordered_json::array();
  for (const ProgramOption& option : path_tracer::program_options()) {
    nlohmann::ordered_json entry = {{"key", key_of_option(option)}, {"group", name_of(option.group)}};
    entry["unit"] = option.unit;
    entry["default"] =
        std::visit([](const auto& value) { return nlohmann::ordered_json(value); }, option.default_value);
    entry["allowed"] = allowed_text(option);
    entry["meaning"] = option.meaning;
    if (!option.chosen.empty()) entry["chosen"] = option.chosen;
    report.push_back(std::move(entry));
  }
  return report;
}

std::string option_markdown() {
  std::string text;
  const path_tracer::OptionGroup* group = nullptr;
  for (const ProgramOption& option : path_tracer::program_options()) {
    if (group == nullptr || *group != option.group)
      text += std::string(text.empty() ? "" : "\n") + "### Firmware: " + name_of(option.group) +
              "\n\n| key | default | allowed | unit | meaning |\n|---|---|---|---|---|\n";
    group = &option.group;
    text += "| `" + key_of_option(option) + "` | " + path_tracer::value_text(option.default_value) + " | " +
            allowed_text(option) + " | " + option.unit + " | " + meaning_and_choice(option) + " |\n";
  }
  return text;
}

}  // namespace testbench
