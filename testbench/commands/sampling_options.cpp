#include "testbench/commands/sampling_options.hpp"

#include <cstdio>
#include <cstdlib>

#include "testbench/commands/named_values.hpp"
#include "testbench/files/atomic_file.hpp"
#include "testbench/film/image_file.hpp"
#include "testbench/sampling/adaptive_plan.hpp"
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
}

std::unique_ptr<SamplePlan> PassOptions::plan(const std::vector<double>& importance, int samples) const {
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

std::string pass_table(const PassRender& render, const SamplePlan& plan) {
  const PixelSamples samples = render.film.samples();
  std::string table = row("passes", std::to_string(render.passes) +
                                        (render.end == PassEnd::time_over ? ", the next would be late" : ""));
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
