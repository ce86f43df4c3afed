#include "testbench/commands/firmware_options.hpp"

#include <algorithm>
#include <cctype>
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
  const auto write = [this, &program, &option](const std::string& text) {
    option.write(program, *value_of(option, text));
    given_.insert(option.name);
  };
  const auto error_of = [&option](const std::string& text) {
    return value_of(option, text) ? "" : "found '" + text + "', allowed is " + allowed_text(option);
  };
  command.add_option_function<std::string>(command_line_name(option), write, sentence(option.meaning))
      ->check(error_of, "")
      ->type_name(value_hint(option))
      ->default_str(option.chosen.empty() ? path_tracer::value_text(option.read(program)) : option.chosen)
      ->group("Firmware: " + std::string(name_of(option.group)));
}

}  // namespace testbench
