#pragma once

#include <string>

namespace testbench {

/// A page that holds all it shows, of a run's statistics file (`csx600 render --stats`) or of a sweep (its
/// directory or its sweep.json).
/// @param image PNG of a run to show; "" for none
/// Throws InputError that names the file, what was found and what is allowed.
std::string report_page(const std::string& run_or_sweep, const std::string& image);

}  // namespace testbench
