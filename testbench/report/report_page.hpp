#pragma once

#include <string>

namespace testbench {

/// Returns a self-contained HTML page about a run, from its statistics file (`csx600 render --stats`), or
/// about a sweep, from its directory or its sweep.json.
/// @param image PNG of the run to show; "" for none
/// @throws InputError that names the file, what was found and what is allowed
std::string report_page(const std::string& run_or_sweep, const std::string& image);

}  // namespace testbench
