#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "firmware/path_tracer/kernels.hpp"
#include "model/chip_config.hpp"
#include "model/timing_style.hpp"

namespace testbench {

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
