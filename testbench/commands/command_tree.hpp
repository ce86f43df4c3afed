#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

/// The command line as data, for completion and the man page: both say what `--help` says.
namespace testbench {

struct CommandOfTree {
  std::string path;  ///< "bench error"; "" for the program itself
  const CLI::App* app;
};

/// The program and all its subcommands, each before its own.
std::vector<CommandOfTree> commands_of(const CLI::App& program);

/// An option or a positional argument as users write it.
struct ArgumentOfTree {
  std::vector<std::string> names;    ///< "-o", "--output"; of a positional argument, its name alone
  std::string value;                 ///< "FILE", "{lt, at}"; "" for a flag
  std::vector<std::string> choices;  ///< its values, where they are listed in braces
  bool takes_file;                   ///< a file or a directory will do
  bool is_positional;
  bool is_required;
  std::string default_text;
  std::string description;
  std::string group;  ///< heading in the command's help
};
std::vector<ArgumentOfTree> arguments_of(const CLI::App& command);

}  // namespace testbench
