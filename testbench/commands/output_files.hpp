#pragma once

#include <CLI/CLI.hpp>
#include <deque>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace testbench {

/// An option that names a file to be written, and the file; "" where the option was not given.
using OutputOption = std::pair<std::string, std::string>;

/// A file that a command reads, and who names it: "--chip", "the scene".
using InputName = std::pair<std::string, std::string>;

/// A check for options that name a file: "" is none.
std::string error_of_no_file(const std::string& path);

/// Throws InputError if two outputs are one file, or an output is an input; paths may be spelled in any way.
void require_outputs_apart(const std::vector<OutputOption>& outputs, const std::vector<InputName>& inputs);

/// The files that a command writes, each named by an option.
class OutputFiles {
 public:
  /// @param names of the option, as CLI11 takes them ("-o,--output"); below, the first long one
  CLI::Option& add_to(CLI::App& command, const std::string& names, const std::string& meaning);

  /// "" where the option was not given.
  const std::string& path(const std::string& option) const;

  /// Whether any option was given.
  bool any() const;

  /// Before the run: throws InputError for a file that cannot be written, and for one that two options name.
  /// @param others are written by somebody else, who checks that they can be
  void require_writable(const std::vector<OutputOption>& others = {}) const;

  /// Before the run, once all inputs are known: throws InputError for an output that would replace an input.
  void require_no_input(const std::vector<InputName>& inputs,
                        const std::vector<OutputOption>& others = {}) const;

  /// Writes what `make` returns, if the option was given.
  void write(const std::string& option, const std::function<std::string()>& make) const;

 private:
  std::vector<OutputOption> with(const std::vector<OutputOption>& others) const;

  std::deque<OutputOption> files_;  // where CLI11 writes, so no element may move
};

}  // namespace testbench
