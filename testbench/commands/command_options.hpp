#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "firmware/path_tracer/kernels.hpp"
#include "model/chip_config.hpp"
#include "testbench/scene/scene.hpp"

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

/// --level: which build of the kernels runs; the bits are the same from each.
class LevelOption {
 public:
  void add_to(CLI::App& command);
  /// Throws InputError for a level that this machine cannot execute.
  path_tracer::Level level() const;

 private:
  std::string level_ = "auto";
};

/// Loads a scene; `size`, "480x480", takes the place of its film's unless it is empty. Throws InputError.
Scene load_scene_for_film(const std::string& path, const std::string& size);

/// Segments without roulette that give the least error for the time (`csx600 bench error`, Cornell box).
inline constexpr int kRouletteStart = 3;

/// Sobol points, lights by solid angle, roulette from kRouletteStart on: the least error for the time.
void choose_best_sampling(path_tracer::ProgramConfig& program);

/// How paths are sampled: --sampler, --light-sampling, --roulette-start, --max-survival, --seed. The defaults
/// are the values in `program`.
void add_sampling_options(CLI::App& command, path_tracer::ProgramConfig& program);

}  // namespace testbench
