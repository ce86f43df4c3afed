#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "testbench/commands/command_options.hpp"
#include "testbench/commands/commands.hpp"
#include "testbench/commands/output_files.hpp"
#include "testbench/files/atomic_file.hpp"
#include "testbench/statistics/json_file.hpp"
#include "testbench/sweep/sweep_columns.hpp"
#include "testbench/sweep/sweep_run.hpp"
#include "testbench/sweep/sweep_table.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/interrupt.hpp"
#include "testbench/system/progress_bar.hpp"
#include "testbench/system/standard_output.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr int kFailuresShown = 5;

struct SweepCommand {
  std::string file;
  std::string output;
  std::vector<std::string> settings;
  bool in_full = false;
  bool retry_failed = false;
  bool with_kernels = false;
  int jobs = 1;
  ReachOption reach;
  TimeLimitOption limit;
  const CLI::Option* jobs_option = nullptr;

  void run();

 private:
  /// Throws InputError on the first rank when any rank cannot; the others get none then.
  std::unique_ptr<Sweep> read(Ranks& ranks) const;
  void run_first(const Sweep& sweep, Ranks& ranks) const;
  void forget_failed(const Sweep& sweep, PointStore& store) const;
  void write_tables(const fs::path& directory, const Sweep& sweep, const PointStore& store) const;
};

std::unique_ptr<Sweep> SweepCommand::read(Ranks& ranks) const {
  std::unique_ptr<Sweep> sweep;
  std::string error;
  try {
    if (!ranks.alone() && jobs_option->count() > 0)
      throw InputError("--jobs: found under mpirun, where each rank runs one point at a time; leave it out");
    sweep = std::make_unique<Sweep>(load_sweep_file(file), settings_of(settings), reach.is_outside_allowed());
    require_columns(*sweep);
  } catch (const InputError& wrong) {
    error = wrong.what();
  }
  for (const std::string& of_rank : ranks.exchange(error)) {
    if (of_rank.empty()) continue;
    if (ranks.is_first()) throw InputError(of_rank);
    return nullptr;  // the first rank says it
  }
  return sweep;
}

void SweepCommand::forget_failed(const Sweep& sweep, PointStore& store) const {
  for (const SweepPoint& point : sweep.points())
    if (const Json* const line = store.find(point.id); line != nullptr && (*line)["status"] == "failed")
      store.forget(point.id);
}

/// Says how many points the sweep's constraints leave out, if any.
void print_constrained(const Json& json) {
  const auto with_status = [&](const char* status) {
    return std::count_if(json["points"].begin(), json["points"].end(),
                         [&](const Json& point) { return point["status"] == status; });
  };
  const auto excluded = with_status("excluded");
  const auto unmet = with_status("unmet");
  if (excluded + unmet > 0)
    std::printf("constraints: %td points were not run, %td that were run do not meet them\n", excluded,
                unmet);
}

void SweepCommand::write_tables(const fs::path& directory, const Sweep& sweep,
                                const PointStore& store) const {
  const Json json = sweep_json(sweep, store, with_kernels ? KernelColumns::shown : KernelColumns::left_out);
  const SweepTables tables = sweep_tables(sweep, json);
  write_together({{directory / "sweep.json", json_text(json, 1) + "\n"},
                  {directory / "sweep.csv", tables.points},
                  {directory / "columns.csv", tables.columns}});
  print_constrained(json);
}

struct Counts {
  std::size_t done = 0;
  std::size_t replayed = 0;
  std::size_t audited = 0;
  std::size_t failed = 0;
};

Counts count(const Sweep& sweep, const PointStore& store) {
  Counts counts;
  for (const SweepPoint& point : sweep.points()) {
    const Json* const line = store.find(point.id);
    if (line == nullptr) continue;
    if ((*line)["status"] == "done") {
      ++counts.done;
      counts.replayed += (*line)["how"] == "replayed";
      counts.audited += (*line)["audited"] == true;
    } else if (++counts.failed <= kFailuresShown) {
      print_note(describe_point(sweep, point) + ": " + (*line)["error"].get<std::string>());
    }
  }
  return counts;
}

std::size_t count_finished(const Sweep& sweep, const PointStore& store) {
  return std::size_t(std::count_if(sweep.points().begin(), sweep.points().end(),
                                   [&](const SweepPoint& point) { return store.find(point.id) != nullptr; }));
}

void SweepCommand::run_first(const Sweep& sweep, Ranks& ranks) const {
  const fs::path directory = output.empty() ? fs::path(file).stem().string() + ".sweep" : output;
  for (const char* const name : kSweepFiles)
    require_outputs_apart({{"--output", (directory / name).string()}}, {{"the sweep file", file}});
  PointStore store(directory, build_digest(sweep.firmware_builds()));
  for (const char* const name : {"sweep.json", "sweep.csv", "columns.csv"})
    require_writable(directory / name);
  if (retry_failed) forget_failed(sweep, store);
  const std::size_t before = count_finished(sweep, store);
  const InterruptGuard interrupt;
  const bool all = [&] {
    ProgressBar bar("sweep");
    return run_sweep(sweep, store, {jobs, in_full, limit.seconds()}, ranks, [&](double share) {
      bar.show(share);
      return !interrupt.requested();
    });
  }();
  write_tables(directory, sweep, store);
  for (const auto& [path, notes] : sweep.notes()) print_notes(notes);
  const Counts counts = count(sweep, store);
  const std::string finished = std::to_string(counts.done + counts.failed) + " of " +
                               std::to_string(sweep.points().size()) + " points are finished in " +
                               directory.string();
  if (!all) throw RunError("interrupted; " + finished + "; the same command goes on");
  std::printf(
      "%zu points in %s: %zu done (%zu replayed, %zu of them audited in full), %zu failed; %zu were there\n",
      sweep.points().size(), directory.c_str(), counts.done, counts.replayed, counts.audited, counts.failed,
      before);
  if (counts.failed > 0)
    throw RunError(std::to_string(counts.failed) + " of " + std::to_string(sweep.points().size()) +
                   " points failed; sweep.csv says why");
}

/// The other ranks wait for points: an error of the first one must not leave them waiting.
void SweepCommand::run() {
  Ranks ranks;
  const std::unique_ptr<Sweep> sweep = read(ranks);
  if (!sweep) return;
  if (!ranks.is_first()) return serve_sweep(*sweep, ranks, limit.seconds());
  if (ranks.alone()) return run_first(*sweep, ranks);
  jobs = 1;
  try {
    run_first(*sweep, ranks);
  } catch (const std::exception& error) {
    print_error(error.what());
    ranks.abort(dynamic_cast<const InputError*>(&error) != nullptr ? 2 : 1);
  }
}

}  // namespace

void add_sweep_command(CLI::App& app) {
  CLI::App& command = *app.add_subcommand(
      "sweep", "Run every combination of parameters of a sweep file; a sweep that was stopped goes on");
  const auto state = std::make_shared<SweepCommand>();
  command.add_option("file", state->file, "TOML file with base values and axes")
      ->type_name("FILE")
      ->required();
  command
      .add_option("-o,--output", state->output,
                  "Directory for sweep.csv, columns.csv, sweep.json and points.jsonl")
      ->check(error_of_no_file, "")
      ->type_name("DIRECTORY")
      ->default_str("the file's name with .sweep");
  command.add_option("--set", state->settings, "One base value, key=value; may be repeated")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  state->reach.add_to(command);
  add_jobs_option(command, state->jobs);
  command.add_flag("--full", state->in_full, "Run every point in full instead of replaying streams");
  command.add_flag("--kernels", state->with_kernels,
                   "Write the results of each kernel as well; a finished sweep is only written anew");
  command.add_flag("--retry-failed", state->retry_failed, "Run points again that failed");
  state->limit.add_to(command);
  state->jobs_option = command.get_option("--jobs");
  command.callback([state] { state->run(); });
}

}  // namespace testbench
