#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <utility>
#include <vector>

#include "model/waves/wave_signals.hpp"

namespace model {

/// File names are relative to the directory of the view, so that the directory can be moved.
struct ViewOptions {
  std::string view_file;  ///< the view's own name, by which GTKWave finds the other files from any directory
  std::string wave_file;  ///< VCD or FST
  std::string chip = "csx600";          ///< root scope of the file (WaveConfig::chip)
  std::vector<WaveInstance> signals;    ///< signals of the file, in its order
  std::uint64_t first_picoseconds = 0;  ///< time at the left edge
  std::uint64_t span_picoseconds = 1;   ///< time from edge to edge
  std::vector<std::pair<WaveSignal, std::string>> filter_files;  ///< value names of these signals
};

/// A GTKWave save file: every signal of the file, grouped by its outermost scope. Throws
/// std::invalid_argument for a file name that is absolute or empty, or an empty span.
void write_wave_view(std::ostream& out, const ViewOptions& options);

/// A GTKWave translate filter file: one line per value.
void write_value_filter(std::ostream& out, const std::vector<ValueName>& names);

}  // namespace model
