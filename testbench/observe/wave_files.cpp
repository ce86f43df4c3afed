#include "testbench/observe/wave_files.hpp"

#include <algorithm>
#include <sstream>

#include "testbench/files/atomic_file.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

/// Time that the view shows when too few blocks were computed: about as long as a few blocks of the
/// intersection stage.
constexpr std::uint64_t kViewPicoseconds = 300'000'000;

/// Number of blocks that the view shows, from the second in the window on, so that the first block's
/// neighbours are visible as well.
constexpr std::size_t kBlocksInView = 4;

model::MemoryCounters memory_counters(const model::Csx600& chip, int array) {
  const model::DdrStatistics ddr = chip.ddr_statistics();
  return {ddr.page_hits, ddr.page_misses, ddr.bytes_read, ddr.bytes_written,
          chip.clear_connect.statistics(chip.array(array).pio).bytes};
}

std::filesystem::path sibling(const std::filesystem::path& file, const std::string& suffix) {
  std::filesystem::path path = file;
  return path.replace_extension().concat(suffix);
}

/// "a.control_unit_state.txt": names of the values of a signal.
std::filesystem::path filter_file(const std::filesystem::path& waves, const model::WaveSignalInfo& signal) {
  std::string name = std::string(signal.scope) + "_" + std::string(signal.name);
  std::replace(name.begin(), name.end(), '.', '_');
  return sibling(waves, "." + name + ".txt");
}

void add_names(std::vector<model::ValueName>& names, std::uint64_t first,
               const std::vector<std::string>& texts) {
  for (const std::string& text : texts) {
    std::string name = text;
    std::replace(name.begin(), name.end(), ' ', '_');  // in a translate filter a blank ends the name
    names.push_back({first++, name});
  }
}

}  // namespace

std::vector<std::filesystem::path> files_beside_waves(const std::filesystem::path& waves) {
  std::vector<std::filesystem::path> files = {sibling(waves, ".gtkw")};
  for (const model::WaveSignalInfo& signal : model::wave_signal_table())
    if (!signal.fixed_names.empty() || signal.names != model::WaveNames::none)
      files.push_back(filter_file(waves, signal));
  return files;
}

void require_writable_waves(const WaveOptions& options, const model::ChipConfig& chip) {
  const std::filesystem::path extension = options.file.extension();
  if (extension != ".vcd" && extension != ".fst")
    throw InputError("--waves: found '" + options.file.string() +
                     "', allowed is a name that ends in .vcd or .fst");
  require_writable(options.file);
  require_writable(sibling(options.file, ".gtkw"));
  try {
    model::check_waves(options.config, chip);
  } catch (const model::WaveError& error) {
    throw InputError(error.what());
  }
}

std::string name_of_array(const model::Csx600& chip, int array) {
  return chip.arrays() == 1 ? chip.name() : std::string(chip.name()) + "_array_" + std::to_string(array);
}

WaveFiles::WaveFiles(const WaveOptions& options, model::Csx600& chip, int array)
    : chip_(chip), array_(array), file_(options.file), stream_(make_wave_stream(options.file)) {
  model::WaveConfig config = options.config;
  config.chip = name_of_array(chip, array);
  try {
    probe_ = std::make_unique<model::WaveProbe>(
        sc_core::sc_gen_unique_name("wave_probe"), config, chip.config(),
        [this](std::string_view text) { stream_->write(text); },
        [&chip, array] { return memory_counters(chip, array); });
  } catch (const model::WaveError& error) {
    throw InputError(error.what());
  }
  if (array == 0) observe_shared_units();
}

void WaveFiles::observe_shared_units() {
  using model::WaveSignal;
  model::Csx600& chip = chip_;
  if (probe_->shows(WaveSignal::clear_connect_to_ddr) || probe_->shows(WaveSignal::clear_connect_from_ddr))
    chip.clear_connect.set_observer(&*probe_);
  const bool shows_ddr = probe_->shows(WaveSignal::ddr_bus) || probe_->shows_ddr_commands();
  if (chip.mono_ddr && shows_ddr) chip.mono_ddr->set_observer(&*probe_, probe_->shows_ddr_commands());
  if (chip.on_chip_sram && probe_->shows(WaveSignal::on_chip_sram_port))
    chip.on_chip_sram->set_observer(&*probe_);
  if (chip.search_unit &&
      (probe_->shows(WaveSignal::search_unit_queries) || probe_->shows(WaveSignal::search_unit_waiting)))
    chip.search_unit->set_observer(&*probe_);
}

void WaveFiles::finish() {
  try {
    probe_->finish();
  } catch (const model::WaveError& error) {
    throw RunError(file_.string() + ": " + error.what());
  }
  stream_->finish();
  write_view();
}

std::vector<model::ValueName> WaveFiles::value_names(const model::WaveSignalInfo& signal) const {
  std::vector<model::ValueName> names = signal.fixed_names;
  switch (signal.names) {
    case model::WaveNames::kernels:
      add_names(names, 1, probe_->kernel_names());
      break;
    case model::WaveNames::bins:
      add_names(names, 1, probe_->bin_names());
      break;
    case model::WaveNames::semaphores:
      add_names(names, 0, chip_.array(array_).control_unit.semaphore_names());
      break;
    default:
      break;
  }
  return names;
}

void WaveFiles::set_span(model::ViewOptions& view) const {
  const std::uint64_t start = probe_->window_start().value();
  const std::uint64_t recorded = probe_->window_end().value() - start;
  view.first_picoseconds = start;
  view.span_picoseconds = std::clamp<std::uint64_t>(recorded, 1, kViewPicoseconds);
  const std::vector<model::Cycles>& blocks = probe_->block_starts();
  if (blocks.size() < kBlocksInView + 2) return;
  view.first_picoseconds = chip_.clock.time_at(blocks[1]).value();
  view.span_picoseconds = chip_.clock.time_at(blocks[kBlocksInView + 1]).value() - view.first_picoseconds;
}

void WaveFiles::write_view() const {
  model::ViewOptions view;
  view.view_file = sibling(file_, ".gtkw").filename().string();
  view.chip = name_of_array(chip_, array_);
  view.wave_file = file_.filename().string();
  view.signals = probe_->signals();
  set_span(view);
  std::vector<std::pair<std::filesystem::path, std::string>> files;
  for (const model::WaveSignalInfo& signal : model::wave_signal_table()) {
    const std::vector<model::ValueName> names = value_names(signal);
    if (names.empty() || !probe_->shows(signal.id)) continue;
    const std::filesystem::path file = filter_file(file_, signal);
    std::ostringstream filter;
    model::write_value_filter(filter, names);
    files.emplace_back(file, filter.str());
    view.filter_files.emplace_back(signal.id, file.filename().string());
  }
  std::ostringstream text;
  model::write_wave_view(text, view);
  files.emplace_back(sibling(file_, ".gtkw"), text.str());
  write_together(files);
}

}  // namespace testbench
