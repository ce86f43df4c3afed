#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "testbench/commands/output_files.hpp"
#include "testbench/passes/pass_render.hpp"
#include "testbench/sampling/sample_plan.hpp"
#include "testbench/scene/scene.hpp"

namespace testbench {

/// --importance: where the paths of a render go.
class ImportanceOption {
 public:
  void add_to(CLI::App& command);
  bool is_given() const { return !file_.empty(); }
  const std::string& file() const { return file_; }
  InputName input() const { return {"--importance", file_}; }
  /// The importance of each pixel, 1 without a map. Throws InputError, also where times `samples` it is too
  /// large.
  std::vector<double> importance(FilmSize film, int samples) const;

 private:
  std::string file_;
};

/// --target-error, --time-budget, --budget-clock, --snapshots, --checkpoint, --every, --resume: options that
/// make a render one of several passes.
class PassOptions {
 public:
  static constexpr double kMostError = 1000;

  void add_to(CLI::App& command);
  bool any() const { return has_target() || !budget_.empty() || !snapshots_.empty() || has_checkpoint(); }
  bool has_checkpoint() const { return !checkpoint_.empty(); }
  bool has_target() const { return target_error_ > 0; }

  /// @param importance of each pixel
  /// @param samples times that are the most paths of a pixel
  std::unique_ptr<SamplePlan> plan(const std::vector<double>& importance, int samples) const;
  /// Throws InputError for what is no time, and for a clock that the machine does not have.
  std::optional<TimeBudget> budget(bool native) const;

  /// Throws InputError for options that do not go together, and for a file that cannot be written or whose
  /// checkpoint would be lost.
  void require_checkpoint() const;
  /// @param identity what determines the result and is in no RenderRequest
  std::optional<CheckpointOptions> checkpoint(const std::string& identity) const;
  OutputOption checkpoint_output() const { return {"--checkpoint", checkpoint_}; }

  /// Makes the folder of the snapshots. Throws InputError if it cannot be written to.
  void prepare_snapshots() const;
  /// Writes the film of a pass, if snapshots are wanted.
  void write_snapshot(const Film& film, int pass, std::map<std::string, std::string> provenance) const;

 private:
  std::filesystem::path snapshot_file(int pass) const;

  double target_error_ = 0;
  std::string budget_;
  std::optional<BudgetClock> clock_;
  std::string snapshots_;
  std::string checkpoint_;
  std::string every_;
  bool resumes_ = false;
};

/// What passes came to, as a table for people.
std::string pass_table(const PassRender& render, const SamplePlan& plan);

}  // namespace testbench
