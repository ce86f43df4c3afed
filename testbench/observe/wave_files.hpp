#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "model/csx600.hpp"
#include "model/waves/wave_probe.hpp"
#include "model/waves/wave_signals.hpp"
#include "model/waves/wave_view.hpp"
#include "testbench/files/output_stream.hpp"
#include "testbench/observe/observation_options.hpp"

namespace testbench {

/// The files that come with the trace `waves`: the view, and every filter that a selection of signals may
/// need.
std::vector<std::filesystem::path> files_beside_waves(const std::filesystem::path& waves);

/// Throws InputError if the trace or its view cannot be written, or if the selection or a window is empty.
void require_writable_waves(const WaveOptions& options, const model::ChipConfig& chip);

/// The chip's name, and of a chip with several arrays the number of the array: the root scope of its waves.
std::string name_of_array(const model::Csx600& chip, int array);

/// The waves of one run: the trace, a GTKWave view of its first blocks, and filters with the names of states
/// and kernels.
class WaveFiles {
 public:
  WaveFiles(const WaveOptions& options, model::Csx600& chip, int array);

  model::ChipObserver& observer() { return *probe_; }

  /// Must be called after the run. Throws RunError if no kernel ran in the windows or a file is not complete;
  /// then the trace is removed.
  void finish();

 private:
  void observe_shared_units();
  void write_view() const;
  std::vector<model::ValueName> value_names(const model::WaveSignalInfo& signal) const;
  void set_span(model::ViewOptions& view) const;

  model::Csx600& chip_;
  int array_;
  std::filesystem::path file_;
  std::unique_ptr<OutputStream> stream_;
  std::unique_ptr<model::WaveProbe> probe_;
};

}  // namespace testbench
