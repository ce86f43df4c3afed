#include <cstdio>
#include <filesystem>
#include <memory>

#include "testbench/commands/command_options.hpp"
#include "testbench/commands/commands.hpp"
#include "testbench/commands/firmware_options.hpp"
#include "testbench/commands/named_values.hpp"
#include "testbench/commands/output_files.hpp"
#include "testbench/faults/fault_campaign.hpp"
#include "testbench/faults/fault_table.hpp"
#include "testbench/faults/fault_text.hpp"
#include "testbench/files/atomic_file.hpp"
#include "testbench/run/program_choice.hpp"
#include "testbench/statistics/statistics_file.hpp"
#include "testbench/sweep/point_store.hpp"
#include "testbench/system/digest.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/interrupt.hpp"
#include "testbench/system/progress_bar.hpp"
#include "testbench/system/ranks.hpp"
#include "testbench/system/standard_output.hpp"

namespace testbench {
namespace {

namespace fs = std::filesystem;

struct InjectCommand {
  SceneArgument scene;
  SizeOption size;
  RenderOptions options;
  ChipOptions chip;
  LevelOption level;
  FirmwareOptions firmware;
  TimeLimitOption limit;
  std::vector<std::string> kinds;
  std::string output;
  int count = 1000;
  int seed = 1;
  int jobs = 1;

  void run();

 private:
  std::vector<model::FaultKind> chosen_kinds() const;
  FaultCampaign campaign_of(const Scene& loaded) const;
  double limit_seconds(const FaultFreeRun& fault_free) const;
  nlohmann::ordered_json description(const FaultCampaign& campaign, const FaultFreeRun& fault_free) const;
};

std::vector<model::FaultKind> InjectCommand::chosen_kinds() const {
  std::vector<model::FaultKind> chosen;
  for (const std::string& kind : kinds) chosen.push_back(fault_kind_of(kind));
  if (chosen.empty())
    for (const model::FaultKindInfo& kind : model::kFaultKinds) chosen.push_back(kind.kind);
  return chosen;
}

FaultCampaign InjectCommand::campaign_of(const Scene& loaded) const {
  FaultCampaign campaign{&loaded, options, chosen_kinds(), std::uint64_t(seed)};
  RenderOptions& of = campaign.options;
  of.chip = chip.chip();
  of.level = level.level();
  of.film_sums = FilmSums::means;
  choose_program(loaded, of.chip, firmware.given(), of.program);
  RenderOptions with_fault = of;
  with_fault.faults = {{model::FaultKind::pio_lost}};
  require_faults(with_fault);
  of.image = make_image(loaded, of);
  return campaign;
}

/// The time limit is for kernels that never end, where no cycle passes that the watchdog could count.
double InjectCommand::limit_seconds(const FaultFreeRun& fault_free) const {
  constexpr double kAtLeastSeconds = 20;
  constexpr double kTimes = 20;
  return limit.seconds() > 0 ? limit.seconds() : kAtLeastSeconds + kTimes * fault_free.cpu_seconds;
}

/// What must be equal for a campaign to go on.
nlohmann::ordered_json InjectCommand::description(const FaultCampaign& campaign,
                                                  const FaultFreeRun& fault_free) const {
  nlohmann::ordered_json names = nlohmann::ordered_json::array();
  for (const model::FaultKind kind : campaign.kinds) names.push_back(info_of(kind).name);
  return {{"format", "csx600-faults-1"},
          {"build", build_digest("")},
          {"scene", scene.path()},
          {"image_sha256", fault_free.image_sha256},
          {"firmware_cycles", fault_free.firmware_cycles},
          {"check_hazards", campaign.options.check_hazards},
          {"ecc", campaign.options.chip.ddr.ecc},
          {"watchdog_cycles", campaign.options.chip.chip.watchdog_cycles},
          {"seed", campaign.seed},
          {"kinds", std::move(names)}};
}

void InjectCommand::run() {
  if (launched_processes() > 1) throw InputError("inject: found mpirun, allowed is one process with --jobs");
  size.require_valid();
  const Scene loaded = size.resized(scene.load());
  const FaultCampaign campaign = campaign_of(loaded);
  const fs::path directory = output.empty() ? fs::path(loaded.name).stem().string() + ".faults" : output;
  const FaultFreeRun fault_free = run_without_faults(campaign, limit.seconds());
  FaultStore store(directory, description(campaign, fault_free));
  require_writable(directory / "faults.csv");
  const std::size_t before = store.runs().size();
  const InterruptGuard interrupt;
  const bool all = [&] {
    ProgressBar bar("inject");
    return run_campaign(campaign, fault_free, count, jobs, limit_seconds(fault_free), store,
                        [&](double share) {
                          bar.show(share);
                          return !interrupt.requested();
                        });
  }();
  const std::vector<FaultRow> rows = fault_rows(store);
  write_bytes_atomically(directory / "faults.csv", fault_csv(rows));
  print_notes(loaded.notes);
  std::printf("%zu runs with one fault each, of %llu cycles without, in %s; %zu were there\n%s",
              store.runs().size(), static_cast<unsigned long long>(fault_free.firmware_cycles),
              directory.c_str(), before, fault_table(rows).c_str());
  if (!all)
    throw RunError("interrupted; " + std::to_string(store.runs().size()) + " of " + std::to_string(count) +
                   " runs are finished; the same command goes on");
}

}  // namespace

void add_inject_command(CLI::App& app) {
  CLI::App& command = *app.add_subcommand(
      "inject", "Render a scene many times with one random hardware fault each, and count what they do");
  const auto state = std::make_shared<InjectCommand>();
  state->options.work.samples = 4;
  state->options.program = path_tracer::default_program();
  state->scene.add_to(command);
  in_range(command.add_option("--count", state->count, "Runs with a fault"), 1, 100'000'000)
      ->capture_default_str();
  in_range(command.add_option("--fault-seed", state->seed, "Of the faults' times and places"), 0, 1 << 26)
      ->capture_default_str();
  command
      .add_option("--kinds", state->kinds,
                  "Kinds of faults, in turn (" + fault_kind_names() + "); all unless given")
      ->delimiter(',')
      ->type_name("KINDS");
  command.add_option("-o,--output", state->output, "Directory for faults.csv and faults.jsonl")
      ->check(error_of_no_file, "")
      ->type_name("DIRECTORY")
      ->default_str("the scene's name with .faults");
  in_range(command.add_option("--samples", state->options.work.samples, "Paths a pixel"), 1, 1 << 30)
      ->capture_default_str();
  state->size.add_to(command);
  add_jobs_option(command, state->jobs);
  state->limit.add_to(command);
  state->chip.add_to(command, "csx600");
  state->level.add_to(command);
  add_check_hazards_flag(command, state->options.check_hazards);
  using path_tracer::OptionGroup;
  state->firmware.add_to(command, state->options.program,
                         {OptionGroup::bins, OptionGroup::sampling, OptionGroup::tree});
  command.callback([state] { state->run(); });
}

}  // namespace testbench
