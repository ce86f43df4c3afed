#include "testbench/commands/command_tree.hpp"

namespace testbench {
namespace {

void collect_commands(const std::string& path, const CLI::App& app, std::vector<CommandOfTree>& commands) {
  commands.push_back({path, &app});
  for (const CLI::App* const command : app.get_subcommands(nullptr))
    collect_commands(path + (path.empty() ? "" : " ") + command->get_name(), *command, commands);
}

/// "lt", "at" of "{lt, at}".
std::vector<std::string> listed_in_braces(const std::string& text) {
  const std::size_t begin = text.find('{');
  const std::size_t end = text.find('}');
  if (begin == std::string::npos || end == std::string::npos) return {};
  std::vector<std::string> words = CLI::detail::split(text.substr(begin + 1, end - begin - 1), ',');
  for (std::string& word : words) CLI::detail::trim(word);
  return words;
}

bool names_file(const std::string& value) {
  const auto is_in_value = [&](const char* kind) { return value.find(kind) != std::string::npos; };
  return is_in_value("FILE") || is_in_value("DIRECTORY") || is_in_value("SCENE");
}

ArgumentOfTree argument_of(const CLI::Option& option) {
  ArgumentOfTree argument{};
  argument.is_positional = option.get_positional();
  if (argument.is_positional) argument.names = {option.get_name(true)};
  for (const std::string& name : option.get_snames()) argument.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) argument.names.push_back("--" + name);
  if (option.get_items_expected_max() > 0) argument.value = option.get_type_name();
  argument.choices = listed_in_braces(argument.value);
  argument.takes_file = names_file(argument.value);
  argument.is_required = option.get_required();
  argument.default_text = option.get_default_str();
  argument.description = option.get_description();
  argument.group = option.get_group();
  return argument;
}

}  // namespace

std::vector<CommandOfTree> commands_of(const CLI::App& program) {
  std::vector<CommandOfTree> commands;
  collect_commands("", program, commands);
  return commands;
}

std::vector<ArgumentOfTree> arguments_of(const CLI::App& command) {
  std::vector<ArgumentOfTree> arguments;
  for (const CLI::Option* const option : command.get_options()) arguments.push_back(argument_of(*option));
  return arguments;
}

}  // namespace testbench
