#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "firmware/path_tracer/kernels.hpp"
#include "model/chip_config.hpp"
#include "testbench/scene/scene.hpp"
#include "model/timing_style.hpp"

namespace testbench {

/// --size, "480x480". Throws InputError.
FilmSize parse_film_size(const std::string& text);
/// --set.
class SetOptions {
 public:
  void add_to(CLI::App& command);
  /// A preset or file with the settings. Throws InputError.
  model::ChipConfig chip(const std::string& name) const;

 private:
  std::vector<std::string> settings_;
};

/// --chip and --set.
class ChipOptions {
 public:
  void add_to(CLI::App& command, const std::string& default_chip);
  /// Throws InputError.
  model::ChipConfig chip() const { return settings_.chip(chip_); }

 private:
  std::string chip_;
  SetOptions settings_;
};

/// --timing.
class TimingOption {
 public:
  void add_to(CLI::App& command);
  model::TimingStyle style() const;
  const std::string& text() const { return text_; }

 private:
  std::string text_ = "lt";
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
