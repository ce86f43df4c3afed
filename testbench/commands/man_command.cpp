#include <cstdio>

#include "testbench/commands/command_tree.hpp"
#include "testbench/commands/commands.hpp"
#include "testbench/commands/exit_codes.hpp"
#include "testbench/commands/version.hpp"

namespace testbench {
namespace {

struct Described {
  const char* what;
  const char* meaning;
};

constexpr Described kFiles[] = {
    {"SCENE/scene.toml", "Camera, film and meshes (glTF or OBJ) of a scene."},
    {"chip.toml", "A chip: a preset and the parameters that differ from it (--chip)."},
    {"sweep.toml", "Base values and axes of a sweep; any key that csx600 params lists."},
    {"NAME.sweep/", "Results of a sweep: points.jsonl, from which it goes on, sweep.csv and sweep.json."},
    {"DIRECTORY/grid.toml", "Runs whose counters csx600 golden keeps beside it, in CSV files."},
};

constexpr Described kExamples[] = {
    {"csx600 render scenes/cornell_box --png box.png --stats box.json",
     "Renders an image on the chip and writes every counter."},
    {"csx600 compare a.json b.json --tolerance 'chip.ddr.*=0.01'",
     "Tells in which counters two runs differ."},
    {"csx600 sweep sweeps/n_by_pio_cost.toml --jobs 2", "Runs every combination of parameters."},
    {"csx600 reproduce", "Prints the paper's tables beside the model's."},
    {"source <(csx600 completion bash)", "Completes commands, options and their values."},
};

/// Text that troff prints as it is.
std::string escaped(const std::string& text) {
  std::string troff;
  for (const char c : text) {
    if (troff.empty() && (c == '.' || c == '\'')) troff += "\\&";
    troff += c == '\\' ? "\\e" : c == '-' ? "\\-" : std::string(1, c);
  }
  return troff;
}

/// ".TP", the option with its value, its meaning and its default.
std::string entry(const ArgumentOfTree& argument) {
  std::string names;
  for (const std::string& name : argument.names) names += (names.empty() ? "" : ", ") + escaped(name);
  std::string text = ".TP\n\\fB" + names + "\\fR";
  if (!argument.value.empty()) text += " \\fI" + escaped(argument.value) + "\\fR";
  text += "\n" + escaped(argument.description) + ".";
  if (argument.is_required) text += " Required.";
  if (!argument.default_text.empty()) text += " Default: " + escaped(argument.default_text) + ".";
  return text + "\n";
}

/// "csx600 render [OPTIONS] scene"
std::string usage(const CommandOfTree& command) {
  std::string text = "csx600 " + command.path;
  std::string positional;
  bool has_options = false;
  for (const ArgumentOfTree& argument : arguments_of(*command.app)) {
    has_options = has_options || (!argument.is_positional && argument.names.back() != "--help");
    if (argument.is_positional)
      positional += argument.is_required ? " " + argument.names[0] : " [" + argument.names[0] + "]";
  }
  return text + (has_options ? " [OPTIONS]" : "") + positional;
}

/// Options in the order of the command's help, a paragraph for each heading that is not the usual one.
std::string section(const CommandOfTree& command) {
  std::string text =
      ".SS " + escaped(usage(command)) + "\n" + escaped(command.app->get_description()) + ".\n";
  std::string group = "Options";
  for (const ArgumentOfTree& argument : arguments_of(*command.app)) {
    if (argument.names.back() == "--help") continue;
    if (argument.group != group) text += ".PP\n\\fI" + escaped(group = argument.group) + "\\fR\n";
    text += entry(argument);
  }
  return text;
}

template <std::size_t count>
std::string list(const char* heading, const Described (&entries)[count]) {
  std::string text = ".SH " + std::string(heading) + "\n";
  for (const Described& of : entries)
    text += ".TP\n\\fB" + escaped(of.what) + "\\fR\n" + escaped(of.meaning) + "\n";
  return text;
}

std::string man_page(const CLI::App& program) {
  std::string text = R"(.TH CSX600 1 "" "csx600 )" + program_version() + R"(" "User Commands")" +
                     "\n.SH NAME\ncsx600 \\- " + escaped(program.get_description()) + R"(
.SH SYNOPSIS
\fBcsx600\fR \fICOMMAND\fR [\fIOPTIONS\fR]
.br
\fBcsx600\fR \fICOMMAND\fR \-\-help
.br
\fBcsx600\fR \-\-version
.SH COMMANDS
)";
  for (const CommandOfTree& command : commands_of(program))
    if (!command.path.empty()) text += section(command);
  text += ".SH EXIT STATUS\n";
  for (const ExitCode& exit : kExitCodes)
    text += ".TP\n\\fB" + std::to_string(exit.code) + "\\fR\n" + escaped(exit.meaning) + "\n";
  return text + list("FILES", kFiles) + list("EXAMPLES", kExamples) +
         R"(.SH SEE ALSO
\fBcsx600 params\fR lists the parameters of the chip and the options of the firmware,
\fBcsx600 stats \-\-describe\fR the counters, \fBcsx600 waves\fR the signals.
)";
}

}  // namespace

void add_man_command(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("man", "Print the manual page: csx600 man > csx600.1");
  command.callback([&app] { std::fputs(man_page(app).c_str(), stdout); });
}

}  // namespace testbench
