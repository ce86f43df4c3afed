#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "firmware/cn/simd/level.hpp"
#include "model/config/chip_config.hpp"
#include "model/config/timing_style.hpp"
#include "testbench/commands/output_files.hpp"
#include "testbench/run/run_settings.hpp"
#include "testbench/scene/scene.hpp"

namespace testbench {

/// --set.
class SetOptions {
 public:
  void add_to(CLI::App& command);
  /// The preset or file `name` with the settings. Throws InputError.
  model::ChipConfig chip(const std::string& name) const;

 private:
  std::vector<std::string> settings_;
};

/// The value of a --set. Throws InputError for a text that is not key=value.
Setting setting_of(const std::string& text);
std::vector<Setting> settings_of(const std::vector<std::string>& texts);

/// --chip and --set.
class ChipOptions {
 public:
  void add_to(CLI::App& command, const std::string& default_chip);
  /// Throws InputError.
  model::ChipConfig chip() const { return settings_.chip(chip_); }
  /// The chip's file, if it is one.
  std::vector<InputName> inputs() const;

 private:
  std::string chip_;
  SetOptions settings_;
};

/// --timing.
class TimingOption {
 public:
  void add_to(CLI::App& command);
  model::TimingStyle style() const { return style_; }

 private:
  model::TimingStyle style_ = model::TimingStyle::loosely_timed;
};

/// --level: which build of the kernels runs; the bits are the same from each.
class LevelOption {
 public:
  void add_to(CLI::App& command);
  /// Throws InputError for a level that this machine cannot execute.
  cn::Level level() const;
  /// The level that was asked for; none for auto.
  std::optional<cn::Level> given() const {
    return choice_ == kWidest ? std::nullopt : std::optional(static_cast<cn::Level>(choice_));
  }

 private:
  using Choice = int;  ///< a level, or kWidest
  static constexpr Choice kWidest = -1;
  Choice choice_ = kWidest;
};

/// --samples, at least one a pixel; the default is the value in `samples`.
void add_samples_option(CLI::App& command, int& samples);

/// --jobs: processes at a time; by default as many as there are cores.
void add_jobs_option(CLI::App& command, int& jobs);

/// --check-hazards.
void add_check_hazards_flag(CLI::App& command, bool& check_hazards);

/// --time-limit: seconds of the wall clock that a run may take.
class TimeLimitOption {
 public:
  void add_to(CLI::App& command);
  double seconds() const { return seconds_; }  ///< 0: no limit

 private:
  int seconds_ = 0;
};

/// --allow-outside: how far scenes may reach. Every command that loads scenes has it.
class ReachOption {
 public:
  void add_to(CLI::App& command);
  bool is_outside_allowed() const { return is_outside_allowed_; }

 private:
  bool is_outside_allowed_ = false;
};

/// The scene as the command's first argument, and --allow-outside.
class SceneArgument {
 public:
  /// A scene that must be given.
  SceneArgument() = default;
  /// One that is `default_scene` if none is given.
  explicit SceneArgument(std::string default_scene) : path_(std::move(default_scene)) {}

  void add_to(CLI::App& command);
  const std::string& path() const { return path_; }
  /// Throws InputError.
  Scene load() const { return load_other(path_); }
  /// Another scene, which may reach as far. Throws InputError.
  Scene load_other(const std::string& path) const;

 private:
  std::string path_;
  ReachOption reach_;
};

/// One scene or more as the command's arguments, and --allow-outside.
class SceneArguments {
 public:
  void add_to(CLI::App& command);
  const std::vector<std::string>& paths() const { return paths_; }
  /// Throws InputError.
  Scene load(const std::string& path) const;

 private:
  std::vector<std::string> paths_;
  ReachOption reach_;
};

/// --size: the film of a scene.
class SizeOption {
 public:
  void add_to(CLI::App& command);
  /// Gives the scene a film of the size, if one is given. Throws InputError.
  Scene resized(Scene scene) const;
  /// Throws InputError for what is no size; before scenes are loaded, which takes longer.
  void require_valid() const;

 private:
  std::string size_;
};

/// The chip's file and the scene's, for OutputFiles::require_no_input().
std::vector<InputName> inputs_of(const ChipOptions& chip, const Scene& scene);

/// Prints notes of scenes on stderr, a line each. A command calls it at its end, so that no note goes before
/// an error.
void print_notes(const Notes& notes);

}  // namespace testbench
