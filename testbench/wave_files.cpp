#include "testbench/wave_files.hpp"

#include <algorithm>
#include <sstream>

#include "model/wave_view.hpp"
#include "testbench/atomic_file.hpp"
#include "testbench/error.hpp"

namespace testbench {
namespace {

/// The control unit catches up with SystemC time this often, so that few changes wait to be shown.
constexpr model::Cycles kSyncCycles = 50'000;

/// What the view opens on: a few blocks of the paper's intersection bin.
constexpr std::uint64_t kViewPicoseconds = 300'000'000;

model::MemoryCounters memory_counters(const model::Csx600& chip) {
  const model::DdrStatistics ddr = chip.ddr_statistics();
  return {ddr.page_hits, ddr.page_misses, ddr.bytes_read, ddr.bytes_written,
          chip.clear_connect.statistics(model::Initiator::pio).bytes};
}

}  // namespace

void require_writable_waves(const WaveOptions& options) {
  if (options.vcd.extension() != ".vcd")
    throw InputError("--vcd: found '" + options.vcd.string() + "', allowed is a name that ends in .vcd");
  if (options.first_cycle >= options.last_cycle)
    throw InputError("--vcd-cycles: found " + std::to_string(options.first_cycle) + ":" +
                     std::to_string(options.last_cycle) + ", allowed is a first cycle below the last");
  require_writable(options.vcd);
}

WaveFiles::WaveFiles(const WaveOptions& options, model::Csx600& chip)
    : chip_(chip), vcd_(options.vcd), temporary_(sibling(".partial.vcd")) {
  try {
    const model::WaveConfig config{temporary_, options.first_cycle, options.last_cycle};
    probe_.emplace("wave_probe", config, chip.clock, [&chip] { return memory_counters(chip); });
  } catch (const model::WaveError& error) {
    throw InputError(error.what());
  }
  chip.control_unit.set_observer(&*probe_, kSyncCycles);
  chip.dma_engine.set_observer(&*probe_);
}

WaveFiles::~WaveFiles() {
  std::error_code ignored;
  std::filesystem::remove(temporary_, ignored);
}

std::filesystem::path WaveFiles::sibling(const std::string& suffix) const {
  std::filesystem::path path = vcd_;
  return path.replace_extension().concat(suffix);
}

void WaveFiles::finish() {
  try {
    probe_->finish();
  } catch (const model::WaveError& error) {
    std::string message = error.what();  // speaks of the temporary name
    const std::size_t found = message.find(temporary_.string());
    if (found != std::string::npos) message.replace(found, temporary_.string().size(), vcd_.string());
    throw RunError(message);
  }
  std::filesystem::rename(temporary_, vcd_);
  write_view();
}

void WaveFiles::add_semaphore_names(std::vector<model::ValueName>& names) const {
  const std::vector<std::string>& semaphores = chip_.control_unit.semaphore_names();
  for (std::size_t i = 0; i < semaphores.size(); ++i) {
    std::string name = semaphores[i];
    std::replace(name.begin(), name.end(), ' ', '_');  // a translate filter ends a name at a blank
    names.push_back({i, name});
  }
}

void WaveFiles::write_view() const {
  const auto& table = model::wave_signal_table();
  model::ViewOptions view;
  view.view_file = sibling(".gtkw").filename().string();
  view.vcd_file = vcd_.filename().string();
  view.first_picoseconds = probe_->window_start().value();
  const std::uint64_t recorded = probe_->window_end().value() - probe_->window_start().value();
  view.span_picoseconds = std::clamp<std::uint64_t>(recorded, 1, kViewPicoseconds);
  for (const model::WaveSignalInfo& signal : table) {
    auto names = model::wave_value_names(signal, probe_->kernel_names());
    if (signal.id == model::WaveSignal::control_semaphore) add_semaphore_names(names);
    if (names.empty()) continue;
    const std::filesystem::path file =
        sibling("." + std::string(signal.scope) + "_" + std::string(signal.name) + ".txt");
    std::ostringstream filter;
    model::write_value_filter(filter, names);
    write_bytes_atomically(file, filter.str());
    view.filter_files.emplace_back(signal.id, file.filename().string());
  }
  std::ostringstream text;
  model::write_wave_view(text, view);
  write_bytes_atomically(sibling(".gtkw"), text.str());
}

}  // namespace testbench
