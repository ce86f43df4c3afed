#include "testbench/observe/observation.hpp"

#include "testbench/system/error.hpp"

namespace testbench {
namespace {

/// How often the control unit synchronises with SystemC time, so that few changes are pending at a time.
constexpr model::Cycles kSyncCycles = 50'000;

template <class File>
void finish_one(std::optional<File>& file, std::string& failures) {
  if (!file) return;
  try {
    file->finish();
  } catch (const RunError& error) {
    failures += (failures.empty() ? "" : "; ") + std::string(error.what());
  }
}

}  // namespace

void require_writable(const ObservationOptions& options, const model::ChipConfig& chip) {
  if (options.waves) require_writable_waves(*options.waves, chip);
  for (const std::filesystem::path& file : {options.transactions, options.timeline})
    if (!file.empty()) require_writable(file);
}

ObservationOptions observation_of_array(const ObservationOptions& options, const model::Csx600& chip,
                                        int array) {
  const model::ChipConfig& config = chip.config();
  if (config.board.chips == 1 && config.chip.arrays == 1) return options;
  const std::string name = name_of_array(chip, array);
  const auto named = [&](const std::filesystem::path& file) {
    if (file.empty()) return file;
    return file.parent_path() / (file.stem().string() + "." + name + file.extension().string());
  };
  ObservationOptions of_array = options;
  if (of_array.waves) of_array.waves->file = named(of_array.waves->file);
  of_array.transactions = named(options.transactions);
  of_array.timeline = named(options.timeline);
  return of_array;
}

Observation::Observation(const ObservationOptions& options, model::Csx600& chip, int array) {
  if (options.waves) observers_.add(waves_.emplace(*options.waves, chip, array).observer());
  if (!options.transactions.empty()) observers_.add(transactions_.emplace(options.transactions, chip, array));
  if (!options.timeline.empty()) observers_.add(timeline_.emplace(options.timeline, chip, array));
  if (!options.any()) return;
  const bool only_waves = waves_ && !transactions_ && !timeline_;
  model::ChipObserver& observer = only_waves ? waves_->observer() : observers_;
  chip.array(array).control_unit.set_observer(&observer, kSyncCycles);
  chip.array(array).pio_engine.set_observer(&observer);
  if (array == 0) chip.host_link.set_observer(&observer);
}

std::string Observation::finish() {
  std::string failures;
  finish_one(waves_, failures);
  finish_one(transactions_, failures);
  finish_one(timeline_, failures);
  return failures;
}

}  // namespace testbench
