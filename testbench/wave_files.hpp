#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "model/csx600.hpp"
#include "model/wave_probe.hpp"
#include "model/wave_signals.hpp"

namespace testbench {

/// Which part of a run to show as waves.
struct WaveOptions {
  std::filesystem::path vcd;  ///< ends in ".vcd"
  model::Cycles first_cycle = 0;
  model::Cycles last_cycle = ~model::Cycles{0};  ///< exclusive
};

/// Throws InputError when the trace cannot be written, or a window is empty.
void require_writable_waves(const WaveOptions& options);

/// The waves of one run: the trace, a GTKWave view on its first blocks and the names of states and kernels.
/// The trace has a temporary name until finish(); without it, nothing is left.
class WaveFiles {
 public:
  WaveFiles(const WaveOptions& options, model::Csx600& chip);
  ~WaveFiles();
  WaveFiles(const WaveFiles&) = delete;
  WaveFiles& operator=(const WaveFiles&) = delete;

  /// After the run. Throws RunError if nothing ran in the window or a file is not complete.
  void finish();

 private:
  std::filesystem::path sibling(const std::string& suffix) const;
  void write_view() const;
  void add_semaphore_names(std::vector<model::ValueName>& names) const;

  model::Csx600& chip_;
  std::filesystem::path vcd_;
  std::filesystem::path temporary_;
  std::optional<model::WaveProbe> probe_;
};

}  // namespace testbench
