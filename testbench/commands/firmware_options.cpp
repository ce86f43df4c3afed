#include "testbench/commands/firmware_options.hpp"

#include <algorithm>
#include <cctype>
#include <functional>
#include <string>
#include <variant>

namespace testbench {
namespace {

using path_tracer::ProgramConfig;
using path_tracer::ProgramOption;

/// What help shows as the option's value: "{lt, at}", "0..8" or "NUMBER".
std::string value_hint(const ProgramOption& option) {
  if (const auto* const range = std::get_if<path_tracer::IntegerRange>(&option.allowed))
    return std::to_string(range->low) + ".." + std::to_string(range->high);
  if (std::holds_alternative<path_tracer::Unsigned64>(option.allowed)) return "INTEGER";
  if (std::holds_alternative<path_tracer::OpenInterval>(option.allowed)) return "NUMBER";
  const std::string one_of = "one of ";
  return "{" + allowed_text(option).substr(one_of.size()) + "}";
}

std::string sentence(std::string text) {
  text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

/// Adds one option whose text, or each of whose `pieces` of text, must be a value that is allowed.
CLI::Option& add_option(CLI::App& command, const ProgramOption& option, const ProgramConfig& defaults,
                        const std::function<std::vector<std::string>(const std::string&)>& pieces,
                        const std::function<void(const std::string&)>& write) {
  const auto error_of = [&option, pieces](const std::string& text) -> std::string {
    for (const std::string& piece : pieces(text))
      if (!value_of(option, piece)) return "found '" + piece + "', allowed is " + allowed_text(option);
    return "";
  };
  return *command
              .add_option_function<std::string>(command_line_name(option), write, sentence(option.meaning))
              ->check(error_of, "")
              ->type_name(value_hint(option))
              ->default_str(option.chosen.empty() ? path_tracer::value_text(option.read(defaults))
                                                  : option.chosen)
              ->group("Firmware: " + std::string(name_of(option.group)));
}

/// "light", "mis" of "light,mis"; a comma at the end leaves an empty piece.
std::vector<std::string> split_list(const std::string& text) {
  std::vector<std::string> pieces{""};
  for (const char c : text)
    if (c == ',')
      pieces.emplace_back();
    else
      pieces.back() += c;
  return pieces;
}

}  // namespace

std::string command_line_name(const ProgramOption& option) {
  std::string name = "--" + option.name;
  std::replace(name.begin(), name.end(), '_', '-');
  return name;
}

void FirmwareOptions::add_to(CLI::App& command, ProgramConfig& program,
                             std::initializer_list<path_tracer::OptionGroup> groups) {
  for (const path_tracer::OptionGroup group : groups)
    for (const ProgramOption& option : path_tracer::program_options())
      if (option.group == group) add_to(command, program, option);
}

void FirmwareOptions::add_to(CLI::App& command, ProgramConfig& program, const ProgramOption& option) {
  const auto whole = [](const std::string& text) { return std::vector<std::string>{text}; };
  add_option(command, option, program, whole, [this, &program, &option](const std::string& text) {
    option.write(program, *value_of(option, text));
    given_.insert(option.name);
  });
}

void FirmwareLists::add_to(CLI::App& command, const ProgramConfig& defaults,
                           const std::vector<const ProgramOption*>& options) {
  for (const ProgramOption* const option : options) {
    CLI::Option& added =
        add_option(command, *option, defaults, split_list, [this, option](const std::string& text) {
          std::vector<path_tracer::OptionValue> values;
          for (const std::string& piece : split_list(text)) values.push_back(*value_of(*option, piece));
          lists_.emplace_back(option, values);
        });
    added.type_name(added.get_type_name() + ",...");
  }
}

GivenOptions FirmwareLists::given() const {
  GivenOptions given;
  for (const auto& [option, values] : lists_) given.insert(option->name);
  return given;
}

std::vector<ProgramConfig> FirmwareLists::product(const ProgramConfig& defaults) const {
  std::vector<ProgramConfig> programs{defaults};
  for (const auto& [option, values] : lists_) {
    std::vector<ProgramConfig> longer;
    for (const ProgramConfig& program : programs)
      for (const path_tracer::OptionValue& value : values) {
        longer.push_back(program);
        option->write(longer.back(), value);
      }
    programs = std::move(longer);
  }
  return programs;
}

}  // namespace testbench
