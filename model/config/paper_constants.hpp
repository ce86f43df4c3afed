#pragma once

// Written by `csx600 calibrate --write model/config/paper_constants.hpp`: the only numbers of the model that
// are fitted to the paper's Tables 1 and 2, on three of their 24 cells.

namespace model {

// poly.code_quality_factor
inline constexpr const char* kPaperCodeQualityFactor = "9.1085";
// pio.per_pe_cycles
inline constexpr const char* kPaperPerPeCycles = "20";
// control.transfer_call_cycles
inline constexpr const char* kPaperTransferCallCycles = "2917";

}  // namespace model
