#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "firmware/path_tracer/kernels/kernels.hpp"
#include "model/config/chip_config.hpp"
#include "model/config/timing_style.hpp"
#include "testbench/run/sampling_choice.hpp"
#include "testbench/run/traversal_choice.hpp"
#include "testbench/scene/scene.hpp"

namespace testbench {

/// --set.
class SetOptions {
 public:
  void add_to(CLI::App& command);
  /// A preset or file with the settings. Throws InputError.
  model::ChipConfig chip(const std::string& name) const;

 private:
  std::vector<std::string> settings_;
};

/// An option that names a file to be written, and the file; "" where the option was not given.
using OutputOption = std::pair<const char*, std::string>;

/// Throws InputError when two options name one file.
void require_files_of_their_own(const std::vector<OutputOption>& outputs);

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

/// --samples, at least one a pixel; the default is the value in `samples`.
void add_samples_option(CLI::App& command, int& samples);

/// --jobs: processes at a time; by default as many as there are cores.
void add_jobs_option(CLI::App& command, int& jobs);

/// --check-hazards.
void add_check_hazards_flag(CLI::App& command, bool& check_hazards);

/// Loads a scene; `size`, "480x480", takes the place of its film's unless it is empty. Throws InputError.
Scene load_scene_for_film(const std::string& path, const std::string& size);

/// How paths are sampled: --sampler, --light-sampling, --roulette-start, --max-survival, --seed. The defaults
/// are the values in `program`.
void add_sampling_options(CLI::App& command, path_tracer::ProgramConfig& program);

/// How rays find triangles: --traversal and what the tree looks like.
class TraversalOption {
 public:
  /// The tree's defaults are those in `program`, which is also where its options go.
  void add_to(CLI::App& command, path_tracer::ProgramConfig& program);
  /// Settles what depends on the scene. Returns why, in a line, or nothing when the user has chosen.
  std::string choose(const Scene& scene, const model::ChipConfig& chip,
                     path_tracer::ProgramConfig& program) const;

 private:
  std::optional<path_tracer::Traversal> chosen_;
  TreeWishes wishes_;
};

}  // namespace testbench
