#include <cstdio>
#include <map>
#include <memory>

#include "testbench/commands/command_tree.hpp"
#include "testbench/commands/commands.hpp"
#include "testbench/commands/named_values.hpp"

namespace testbench {
namespace {

enum class Shell : std::uint8_t { bash, zsh };

/// Words that bash splits at blanks; no name of the program has any other special character.
std::string words_of(const std::vector<std::string>& words) {
  return CLI::detail::join(words, " ");
}

/// "render:--exr" | "render:--png": the options of a command, as they precede a value.
std::string patterns_of(const std::string& command, const std::vector<std::string>& names) {
  const auto pattern = [&](const std::string& name) { return "\"" + command + ":" + name + "\""; };
  return CLI::detail::join(names, pattern, " | ");
}

/// What follows an option that takes a value: its choices, a file, or any text.
std::string value_cases(const std::vector<CommandOfTree>& commands) {
  std::string cases;
  for (const CommandOfTree& command : commands)
    for (const ArgumentOfTree& argument : arguments_of(*command.app)) {
      if (argument.is_positional || argument.value.empty()) continue;
      cases += "    " + patterns_of(command.path, argument.names) + ") words=\"" +
               words_of(argument.choices) + "\" files=" + (argument.takes_file ? "1" : "") + " ;;\n";
    }
  return cases;
}

/// What a command takes where no value is asked for.
std::string command_cases(const std::vector<CommandOfTree>& commands) {
  std::string cases;
  for (const CommandOfTree& command : commands) {
    std::vector<std::string> options;
    std::vector<std::string> words;
    bool takes_file = false;
    for (const ArgumentOfTree& argument : arguments_of(*command.app)) {
      if (!argument.is_positional)
        options.insert(options.end(), argument.names.begin(), argument.names.end());
      if (!argument.is_positional) continue;
      words.insert(words.end(), argument.choices.begin(), argument.choices.end());
      takes_file = takes_file || argument.takes_file;
    }
    for (const CLI::App* const subcommand : command.app->get_subcommands(nullptr))
      words.push_back(subcommand->get_name());
    cases += "    \"" + command.path + "\") options=\"" + words_of(options) + "\" words=\"" +
             words_of(words) + "\" files=" + (takes_file ? "1" : "") + " ;;\n";
  }
  return cases;
}

/// "bench:error" leads to the command "bench error".
std::string path_cases(const std::vector<CommandOfTree>& commands) {
  std::string cases;
  for (const CommandOfTree& command : commands) {
    const std::size_t blank = command.path.rfind(' ');
    const std::string parent = blank == std::string::npos ? "" : command.path.substr(0, blank);
    if (!command.path.empty())
      cases +=
          "      \"" + parent + ":" + command.app->get_name() + "\") command=\"" + command.path + "\" ;;\n";
  }
  return cases;
}

std::string bash_script(const CLI::App& program) {
  const std::vector<CommandOfTree> commands = commands_of(program);
  return R"(# Completion of csx600 for bash, written by `csx600 completion bash`. To use it, add to ~/.bashrc:
#     source <(csx600 completion bash)
_csx600() {
  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]}
  if [[ $current == "=" ]]; then  # --option=
    current=""
  elif [[ $previous == "=" ]]; then  # --option=value
    previous=${COMP_WORDS[COMP_CWORD-2]}
  fi
  local command="" options="" words="" files="" i
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case "$command:${COMP_WORDS[i]}" in
)" + path_cases(commands) +
         R"(    esac
  done
  case "$command" in
)" + command_cases(commands) +
         R"(  esac
  case "$command:$previous" in
)" + value_cases(commands) +
         R"(    *) [[ $current == -* ]] && words=$options files="" ;;
  esac
  local IFS=$'\n'
  COMPREPLY=($(compgen -W "${words// /$'\n'}" -- "$current"))
  [[ -n $files ]] && COMPREPLY+=($(compgen -f -- "$current"))
  return 0
}
complete -o filenames -F _csx600 csx600
)";
}

std::string zsh_script(const CLI::App& program) {
  return "# For zsh, by way of its bash completion. To use it, add to ~/.zshrc:\n"
         "#     source <(csx600 completion zsh)\n"
         "autoload -U +X compinit bashcompinit\n"
         "(( $+functions[compdef] )) || compinit\n"
         "bashcompinit\n" +
         bash_script(program);
}

}  // namespace

void add_completion_command(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("completion", "Print a script that completes commands and options");
  const auto shell = std::make_shared<Shell>(Shell::bash);
  const std::map<std::string, Shell> shells = {{"bash", Shell::bash}, {"zsh", Shell::zsh}};
  one_of(command.add_option("shell", *shell, "Shell to write for"), shells)->required();
  command.callback([&app, shell] {
    std::fputs((*shell == Shell::bash ? bash_script(app) : zsh_script(app)).c_str(), stdout);
  });
}

}  // namespace testbench
