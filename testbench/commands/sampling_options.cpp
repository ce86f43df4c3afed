#include "testbench/commands/sampling_options.hpp"

#include <cstdio>
#include <cstdlib>

#include "testbench/commands/named_values.hpp"
#include "testbench/files/atomic_file.hpp"
#include "testbench/film/image_file.hpp"
#include "testbench/sampling/adaptive_plan.hpp"
#include "testbench/sampling/fixed_plan.hpp"
#include "testbench/sampling/importance_map.hpp"
#include "testbench/sampling/time_budget.hpp"
#include "testbench/system/error.hpp"

namespace testbench {

void ImportanceOption::add_to(CLI::App& command) {
  command
      .add_option(
          "--importance", file_,
          "OpenEXR image of the film's size: its luminance, or its only channel, times --samples is the "
          "mean number of paths of each pixel")
      ->check(error_of_no_file, "")
      ->type_name("FILE");
}

std::vector<double> ImportanceOption::importance(FilmSize film, int samples) const {
  const std::size_t pixels = std::size_t(film.width) * std::size_t(film.height);
  if (!is_given()) return std::vector<double>(pixels, 1.0);
  std::vector<double> importance = read_importance(file_, film);
  require_countable(importance, samples, file_, film);
  return importance;
}

namespace {

std::string error_of_target(const std::string& text) {
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  const bool is_number = end == text.c_str() + text.size() && !text.empty();
  if (is_number && number > 0 && number <= PassOptions::kMostError) return "";
  return "found '" + text + "', allowed is a number above 0, at most " +
         std::to_string(int(PassOptions::kMostError));
}

std::string error_of_duration(const std::string& text) {
  return parse_duration(text) ? "" : "found '" + text + "', allowed is " + allowed_duration();
}

std::string error_of_no_folder(const std::string& text) {
  return text.empty() ? "found '', allowed is the name of a folder" : "";
}

std::string text(const char* format, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof(buffer), format, value);
  return buffer;
}

std::string row(const std::string& label, const std::string& value) {
  return "  " + label + std::string(25 - label.size(), ' ') + value + "\n";
}

}  // namespace

void PassOptions::add_to(CLI::App& command) {
  command
      .add_option(
          "--target-error", target_error_,
          "Adaptive sampling: paths go where they help most until the picture's relative RMSE, as its "
          "samples tell, is at most this; --samples is the most of a pixel. Relative RMSE: root of the "
          "mean over pixels and channels of variance of the mean / (mean^2 + (a tenth of the picture's "
          "mean)^2)")
      ->check(error_of_target, "")
      ->type_name("ERROR");
  command
      .add_option(
          "--time-budget", budget_,
          "Passes of samples until this much time is over or the samples are: 500ms, 2s, 5min. No pass "
          "begins that is predicted to end later")
      ->check(error_of_duration, "")
      ->type_name("TIME");
  one_of(
      command.add_option("--budget-clock", clock_,
                         "Clock of --time-budget: chip is simulated time, simulator the wall time of this "
                         "program; by default the chip's, with --native the simulator's"),
      std::map<std::string, BudgetClock>{{"chip", BudgetClock::chip}, {"simulator", BudgetClock::simulator}});
  command
      .add_option(
          "--snapshots", snapshots_,
          "Write the picture after each pass to this folder, as pass_001.exr and so on; each pass has "
          "as many paths as all before it")
      ->check(error_of_no_folder, "")
      ->type_name("FOLDER");
  command
      .add_option("--checkpoint", checkpoint_,
                  "Keep what is done in this file, from which --resume goes on after a kill or a loss of "
                  "power; the render is made in passes of about a million paths")
      ->check(error_of_no_file, "")
      ->type_name("FILE");
  command
      .add_option("--every", every_,
                  "Write the checkpoint at the first end of a pass after so much wall time; by default 60s")
      ->check(error_of_duration, "")
      ->type_name("TIME");
  command.add_flag("--resume", resumes_, "Go on from the file of --checkpoint, to the same image");
}

std::unique_ptr<SamplePlan> PassOptions::plan(const std::vector<double>& importance, int samples) const {
  if (has_checkpoint()) return std::make_unique<FixedPlan>(importance, samples);
  if (has_target()) return std::make_unique<AdaptivePlan>(importance, samples, target_error_);
  return std::make_unique<ShapedPlan>(importance, samples);
}

std::optional<TimeBudget> PassOptions::budget(bool native) const {
  if (budget_.empty()) {
    if (clock_) throw InputError("--budget-clock: found without --time-budget; allowed with it");
    return std::nullopt;
  }
  if (native && clock_ == BudgetClock::chip)
    throw InputError(
        "--budget-clock: found chip with --native, a native run has no clock; allowed is simulator");
  return TimeBudget{*parse_duration(budget_),
                    clock_.value_or(native ? BudgetClock::simulator : BudgetClock::chip)};
}

void PassOptions::require_checkpoint() const {
  if (!has_checkpoint()) {
    if (resumes_ || !every_.empty())
      throw InputError(std::string(resumes_ ? "--resume" : "--every") +
                       ": found without --checkpoint; allowed with it");
    return;
  }
  if (has_target() || !budget_.empty() || !snapshots_.empty())
    throw InputError(
        "--checkpoint: found with --target-error, --time-budget or --snapshots, whose passes end elsewhere; "
        "allowed without them");
  require_writable(checkpoint_);
  std::error_code ignored;
  if (!resumes_ && std::filesystem::exists(checkpoint_, ignored))
    throw InputError("--checkpoint: found '" + checkpoint_ +
                     "', which exists; allowed: a new file, or --resume to go on from this one");
}

std::optional<CheckpointOptions> PassOptions::checkpoint(const std::string& identity) const {
  if (!has_checkpoint()) return std::nullopt;
  CheckpointOptions options;
  options.file = checkpoint_;
  if (!every_.empty()) options.every_seconds = *parse_duration(every_);
  options.resumes = resumes_;
  options.identity = identity;
  return options;
}

std::filesystem::path PassOptions::snapshot_file(int pass) const {
  char name[32];
  std::snprintf(name, sizeof(name), "pass_%03d.exr", pass);
  return std::filesystem::path(snapshots_) / name;
}

void PassOptions::prepare_snapshots() const {
  if (snapshots_.empty()) return;
  std::error_code error;
  std::filesystem::create_directories(snapshots_, error);
  if (error || !std::filesystem::is_directory(snapshots_))
    throw InputError("--snapshots: found '" + snapshots_ +
                     "', which cannot be made a folder; allowed is the name of one");
  require_writable(snapshot_file(1));
}

void PassOptions::write_snapshot(const Film& film, int pass,
                                 std::map<std::string, std::string> provenance) const {
  if (snapshots_.empty()) return;
  provenance["csx600.pass"] = std::to_string(pass);
  write_exr(snapshot_file(pass), film, provenance);
}

namespace {

const char* text_of(PassEnd end) {
  if (end == PassEnd::plan_complete) return "";
  return end == PassEnd::time_over ? ", the next would be late" : ", the next was interrupted";
}

}  // namespace

std::string pass_table(const PassRender& render, const SamplePlan& plan) {
  const PixelSamples samples = render.film.samples();
  std::string table = row("passes", std::to_string(render.passes) + text_of(render.end));
  table += row("paths a pixel", text("%.2f", samples.mean) + ", from " + std::to_string(samples.fewest) +
                                    " to " + std::to_string(samples.most));
  if (plan.error()) table += row("relative RMSE", text("%.4f, as the samples tell", *plan.error()));
  table += row("path segments", std::to_string(render.segments));
  if (render.simulated_seconds)
    table += row("simulated time", text("%.6f s", *render.simulated_seconds) + " in all passes");
  return table + row("simulator time",
                     text("%.2f s CPU", render.cpu_seconds) + text(", %.2f s wall", render.wall_seconds));
}

}  // namespace testbench
