#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "testbench/commands/output_files.hpp"
#include "testbench/sampling/sample_counts.hpp"
#include "testbench/scene/scene.hpp"

namespace testbench {

/// --importance: where the paths of a render go.
class ImportanceOption {
 public:
  void add_to(CLI::App& command);
  bool is_given() const { return !file_.empty(); }
  const std::string& file() const { return file_; }
  InputName input() const { return {"--importance", file_}; }
  /// The mean number of paths of each pixel: `samples` without a map. Throws InputError.
  MeanSamples means(FilmSize film, int samples) const;

 private:
  std::string file_;
};

}  // namespace testbench
