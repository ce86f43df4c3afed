#pragma once

#include <CLI/CLI.hpp>
#include <initializer_list>
#include <utility>
#include <vector>

#include "firmware/path_tracer/program/program_options.hpp"
#include "testbench/run/traversal_choice.hpp"

namespace testbench {

/// "--bin-blocks"
std::string command_line_name(const path_tracer::ProgramOption& option);

/// The firmware's options on a command line, as their table declares them (program_options.hpp).
class FirmwareOptions {
 public:
  /// Adds the options of these groups. They write to `program`, whose values are the defaults.
  void add_to(CLI::App& command, path_tracer::ProgramConfig& program,
              std::initializer_list<path_tracer::OptionGroup> groups);
  /// Adds one option.
  void add_to(CLI::App& command, path_tracer::ProgramConfig& program,
              const path_tracer::ProgramOption& option);

  const GivenOptions& given() const { return given_; }

 private:
  GivenOptions given_;
};

/// The firmware's options on the command line of a command that compares them: each takes a list,
/// "light,mis".
class FirmwareLists {
 public:
  void add_to(CLI::App& command, const path_tracer::ProgramConfig& defaults,
              const std::vector<const path_tracer::ProgramOption*>& options);

  GivenOptions given() const;

  /// The defaults with every combination of the values given; the lists given last vary fastest.
  std::vector<path_tracer::ProgramConfig> product(const path_tracer::ProgramConfig& defaults) const;

 private:
  std::vector<std::pair<const path_tracer::ProgramOption*, std::vector<path_tracer::OptionValue>>> lists_;
};

}  // namespace testbench
