#include "testbench/run/technology.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace testbench {
namespace {

/// A row of the scaling table. Energy of an event at V volts is proportional to a V^2 + b V + c.
struct ProcessNode {
  int nm;
  double a, b, c;          ///< of the energy's polynomial
  double area;             ///< of the same circuit, over that at 130 nm
  double leakage_mw_8kib;  ///< of an SRAM of 8 KiB at the usual voltage
  double usual_voltage_v;
};

// Polynomials and areas: Stillmaker and Baas, Integration 58, 2017. Leakage: CACTI 7.0, ITRS
// high-performance cells, 330 K; 20 nm has CACTI's 22 nm, and smaller nodes, which CACTI does not know, keep
// it. Usual voltages: assumed, as in the ITRS roadmaps.
constexpr std::array<ProcessNode, 10> kNodes = {{{130, 7.171, -6.709, 2.904, 1, 2.16, 1.2},
                                                 {90, 4.762, -4.781, 2.092, 0.44, 2.44, 1.1},
                                                 {65, 3.755, -4.398, 1.975, 0.23, 8.46, 1.1},
                                                 {45, 1.103, -0.362, 0.2767, 0.16, 7.51, 1.0},
                                                 {32, 0.9559, -0.7823, 0.471, 0.072, 1.87, 0.9},
                                                 {20, 0.373, -0.1582, 0.04104, 0.033, 0.924, 0.9},
                                                 {16, 0.2958, -0.1241, 0.03024, 0.030, 0.924, 0.8},
                                                 {14, 0.2363, -0.09675, 0.02239, 0.027, 0.924, 0.8},
                                                 {10, 0.2068, -0.09311, 0.02375, 0.016, 0.924, 0.75},
                                                 {7, 0.1776, -0.09097, 0.02447, 0.0092, 0.924, 0.7}}};
constexpr int kSmallestNodeOfLeakage_nm = 20;
constexpr double kBytesPerKib = 1024;
constexpr double kSmallestSramBytes = 2048;
constexpr double kLargestSramBytes = 1 << 20;

double event_energy(const ProcessNode& node, double volts) {
  return node.a * volts * volts + node.b * volts + node.c;
}

TechnologyFactors factors_at(const ProcessNode& node, double volts) {
  const ProcessNode& reference = kNodes.front();
  return {event_energy(node, volts) / event_energy(reference, reference.usual_voltage_v),
          node.leakage_mw_8kib / reference.leakage_mw_8kib * (volts / node.usual_voltage_v), node.area};
}

double geometric(double from, double to, double share) {
  return from * std::pow(to / from, share);
}

/// A node of the table, or the place between two of them.
struct Place {
  const ProcessNode* above;
  const ProcessNode* below;  ///< `above` itself if the node is in the table
  double share;              ///< way from `above` to `below`
};

Place place_of(int nm) {
  const auto is_above = [nm](const ProcessNode& node) { return node.nm > nm; };
  const auto* below = std::find_if_not(kNodes.begin(), kNodes.end(), is_above);
  if (below->nm == nm) return {below, below, 0};
  const auto* above = below - 1;
  return {above, below, std::log(double(nm) / above->nm) / std::log(double(below->nm) / above->nm)};
}

std::string size_note(const char* key, double bytes) {
  std::array<char, 160> text;
  std::snprintf(text.data(), text.size(),
                "%s %.0f is outside 2048 to 1048576 bytes, for which energy of SRAM is fitted", key, bytes);
  return text.data();
}

bool is_fitted(double bytes) {
  return bytes >= kSmallestSramBytes && bytes <= kLargestSramBytes;
}

}  // namespace

TechnologyFactors technology_factors(const model::ChipConfig::Technology& technology) {
  const Place place = place_of(technology.node_nm);
  const TechnologyFactors above = factors_at(*place.above, technology.voltage_v);
  const TechnologyFactors below = factors_at(*place.below, technology.voltage_v);
  return {geometric(above.energy, below.energy, place.share),
          geometric(above.leakage, below.leakage, place.share),
          geometric(above.area, below.area, place.share)};
}

double sram_access_factor(double bytes, double reference_bytes) {
  return std::sqrt(bytes / reference_bytes);
}

double added_poly_sram_kib(const model::ChipConfig& config) {
  return (config.poly.sram_bytes - kReferencePolySramBytes) / kBytesPerKib;
}

double added_on_chip_sram_kib(const model::ChipConfig& config) {
  return (double(config.on_chip_sram.size_bytes) - kReferenceOnChipSramBytes) / kBytesPerKib;
}

std::vector<std::string> technology_notes(const model::ChipConfig& config) {
  std::vector<std::string> notes;
  const model::ChipConfig::Technology& technology = config.technology;
  const Place place = place_of(technology.node_nm);
  const double usual = geometric(place.above->usual_voltage_v, place.below->usual_voltage_v, place.share);
  std::array<char, 160> text;
  if (technology.voltage_v < 0.7 * usual || technology.voltage_v > 1.15 * usual) {
    std::snprintf(text.data(), text.size(), "technology.voltage_v %.4g is far from the %.2f V usual at %d nm",
                  technology.voltage_v, usual, technology.node_nm);
    notes.emplace_back(text.data());
  }
  if (technology.node_nm < kSmallestNodeOfLeakage_nm) {
    std::snprintf(
        text.data(), text.size(),
        "technology.node_nm %d is below %d nm, where leakage is no longer known: that of 22 nm is used",
        technology.node_nm, kSmallestNodeOfLeakage_nm);
    notes.emplace_back(text.data());
  }
  const double poly_bytes = config.poly.sram_bytes;
  const double on_chip_bytes = double(config.on_chip_sram.size_bytes);
  if (!is_fitted(poly_bytes)) notes.push_back(size_note("poly.sram_bytes", poly_bytes));
  if (on_chip_bytes > 0 && !is_fitted(on_chip_bytes))
    notes.push_back(size_note("on_chip_sram.size_bytes", on_chip_bytes));
  return notes;
}

}  // namespace testbench
