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

Observation::Observation(const ObservationOptions& options, model::Csx600& chip) {
  if (options.waves) observers_.add(waves_.emplace(*options.waves, chip).observer());
  if (!options.transactions.empty()) observers_.add(transactions_.emplace(options.transactions, chip));
  if (!options.timeline.empty()) observers_.add(timeline_.emplace(options.timeline, chip));
  if (!options.any()) return;
  const bool only_waves = waves_ && !transactions_ && !timeline_;
  model::ChipObserver& observer = only_waves ? waves_->observer() : observers_;
  chip.control_unit.set_observer(&observer, kSyncCycles);
  chip.pio_engine.set_observer(&observer);
  chip.host_link.set_observer(&observer);
}

std::string Observation::finish() {
  std::string failures;
  finish_one(waves_, failures);
  finish_one(transactions_, failures);
  finish_one(timeline_, failures);
  return failures;
}

}  // namespace testbench
