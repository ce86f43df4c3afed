#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <utility>
#include <vector>

#include "firmware/path_tracer/kernels.hpp"
#include "model/chip_config.hpp"
#include "testbench/scene/scene.hpp"

namespace testbench {

/// --size, "480x480". Throws InputError.
FilmSize parse_film_size(const std::string& text);

/// An option that names a file to be written, and the file; "" where the option was not given.
using OutputOption = std::pair<const char*, std::string>;

/// Throws InputError when two options name one file.
void require_files_of_their_own(const std::vector<OutputOption>& outputs);

/// --chip and --set.
class ChipOptions {
 public:
  void add_to(CLI::App& command, const std::string& default_chip);
  /// Throws InputError.
  model::ChipConfig chip() const;

 private:
  std::string chip_;
  std::vector<std::string> settings_;
};

/// --level: which build of the kernels runs; the bits are the same from each.
class LevelOption {
 public:
  void add_to(CLI::App& command);
  /// Throws InputError for a level that this machine cannot execute.
  path_tracer::Level level() const;

 private:
  std::string level_ = "auto";
};

}  // namespace testbench
