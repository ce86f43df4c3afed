#include "model/waves/wave_selection.hpp"

#include <fnmatch.h>

#include <algorithm>

namespace model {
namespace {

bool matches(const std::string& glob, const WaveInstance& signal) {
  return fnmatch(glob.c_str(), signal.path.c_str(), 0) == 0;
}

void check_globs(const std::vector<std::string>& globs, const std::vector<WaveInstance>& signals) {
  for (const std::string& glob : globs) {
    const auto found = [&](const WaveInstance& signal) { return matches(glob, signal); };
    if (std::none_of(signals.begin(), signals.end(), found))
      throw WaveError("waves: found the pattern '" + glob +
                      "', which no signal of this chip matches; allowed: shell patterns on names as "
                      "`csx600 waves` lists them");
  }
}

void check_pes(const WaveSelection& selection, int pes) {
  for (const int pe : selection.pes.value_or(std::vector<int>{}))
    if (pe < 0 || pe >= pes)
      throw WaveError("waves: found PE " + std::to_string(pe) + "; allowed: 0 to " + std::to_string(pes - 1));
}

bool is_chosen(const WaveInstance& signal, const WaveSelection& selection) {
  const bool any_glob = selection.globs.empty();
  const bool by_name = any_glob || std::any_of(selection.globs.begin(), selection.globs.end(),
                                               [&](const auto& glob) { return matches(glob, signal); });
  if (!by_name) return false;
  if (signal.info->count == WaveCount::pe && selection.pes)
    return std::find(selection.pes->begin(), selection.pes->end(), signal.index) != selection.pes->end();
  const WaveLevel level = selection.level.value_or(any_glob ? WaveLevel::units : WaveLevel::detail);
  return signal.info->level <= level;
}

}  // namespace

std::vector<WaveInstance> select_waves(const ChipConfig& config, const WaveSelection& selection) {
  std::vector<WaveInstance> signals = wave_instances(config);
  check_globs(selection.globs, signals);
  check_pes(selection, config.chip.pes);
  signals.erase(std::remove_if(signals.begin(), signals.end(),
                               [&](const auto& signal) { return !is_chosen(signal, selection); }),
                signals.end());
  if (signals.empty())
    throw WaveError(
        "waves: found a selection of patterns, level and PEs that leaves no signal; allowed: one "
        "that leaves at least one");
  return signals;
}

}  // namespace model
