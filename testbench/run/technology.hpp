#pragma once

#include <string>
#include <vector>

#include "model/config/chip_config.hpp"

namespace testbench {

/// Factors on figures of 130 nm and 1.2 V, the process for which the chip's energy and area are calibrated.
struct TechnologyFactors {
  double energy;   ///< of an event
  double leakage;  ///< power
  double area;
};

/// Between two nodes of the table, factors are interpolated geometrically over the logarithm of the node.
TechnologyFactors technology_factors(const model::ChipConfig::Technology& technology);

/// SRAM of a PE that the figures of a PE include: the CSX600's.
constexpr double kReferencePolySramBytes = 6144;
/// Size of on_chip_sram for which its energy is stated, and which the rest of the chip's leakage and area
/// include.
constexpr double kReferenceOnChipSramBytes = 131072;

/// Energy of an access to an SRAM of one bank, over that of one of `reference_bytes`. Word and bit lines grow
/// with the edge of the array, so the energy grows with the square root of the size. That is within 6 % of
/// CACTI's mean of read and write at 130 and 22 nm, within 13 % at 45 nm, for 2 KiB to 1 MiB.
double sram_access_factor(double bytes, double reference_bytes);

/// SRAM of a PE, and of the chip, beyond what its figures include; negative if it has less.
double added_poly_sram_kib(const model::ChipConfig& config);
double added_on_chip_sram_kib(const model::ChipConfig& config);

/// One line for each number of the chip for which the factors are extrapolated.
std::vector<std::string> technology_notes(const model::ChipConfig& config);

}  // namespace testbench
