#include "testbench/statistics/verdict.hpp"

#include <algorithm>
#include <cstdio>

#include "testbench/statistics/roofline.hpp"

namespace testbench {
namespace {

using model::CycleCause;

/// Below this share nothing is busy enough to be what holds the run up: units wait for one another.
constexpr double kBusy = 0.7;
constexpr std::size_t kWaitsNamed = 2;

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.1f %%", 100 * share);
  return text;
}

double ratio(double amount, double of) {
  return of > 0 ? amount / of : 0;
}

double control_unit_cycles(const model::ControlStatistics& control) {
  return double(control[CycleCause::mono] + control[CycleCause::data_cache] + control[CycleCause::semaphore] +
                control[CycleCause::transfer_call] + control[CycleCause::thread_switch]);
}

/// The PIO engines of all arrays.
int pio_engines(const ChipStatistics& statistics) {
  const bool has_two = statistics.config.pio.arbitration == model::PioArbitration::queue_per_direction;
  return statistics.arrays() * (has_two ? 2 : 1);
}

/// Without what the engines wait for answers of search units, which is these units' time.
double pio_cycles(const ChipStatistics& statistics) {
  return std::max(0.0,
                  double(statistics.pio.busy_cycles()) - double(statistics.search_unit.answer_wait_cycles));
}

std::vector<UnitUse> uses_of(const ChipStatistics& statistics) {
  const double array_time = double(statistics.firmware_cycles) * statistics.arrays();
  const double chip_time = double(statistics.firmware_cycles) * statistics.config.board.chips;
  const model::ControlStatistics& control = statistics.control;
  std::vector<UnitUse> uses = {
      {"pe_array", ratio(double(control[CycleCause::poly] + control[CycleCause::stolen]), array_time)},
      {"pio", ratio(pio_cycles(statistics), double(statistics.firmware_cycles) * pio_engines(statistics))},
      {"clear_connect", roofline_of(statistics).roof("clear_connect").share()},
      {"ddr", ratio(double(statistics.ddr.busy_cycles), chip_time)},
      {"on_chip_sram", ratio(double(statistics.on_chip_sram.busy_cycles), chip_time)},
      {"control_unit", ratio(control_unit_cycles(control), array_time)},
      {"host_link", ratio(double(statistics.host_link.busy_cycles), double(statistics.total_cycles))}};
  const int search_units = statistics.config.search_unit.units;
  if (search_units > 0)
    uses.push_back(
        {"search_unit", ratio(double(statistics.search_unit.busy_cycles), chip_time * search_units)});
  return uses;
}

/// "66.3 % turns of PEs, 20.1 % memory, 6.4 % setup", of the time.
std::string parts_of_pio(const ChipStatistics& statistics) {
  const double time = double(statistics.firmware_cycles) * pio_engines(statistics);
  std::vector<std::pair<double, const char*>> parts = {
      {double(statistics.pio.pe_cycles) / time, "turns of PEs"},
      {double(statistics.pio.memory_wait_cycles) / time, "memory"},
      {double(statistics.pio.setup_cycles) / time, "setup"}};
  std::stable_sort(parts.begin(), parts.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::string text;
  for (const auto& [share, what] : parts) text += (text.empty() ? "" : ", ") + percent(share) + " " + what;
  return text;
}

/// "intersect 25.1 %, scatter 12.0 %": the kernels that took longest.
std::string longest_kernels(const ChipStatistics& statistics) {
  std::vector<const model::KernelStatistics*> kernels;
  for (const model::KernelStatistics& kernel : statistics.kernels) kernels.push_back(&kernel);
  std::stable_sort(kernels.begin(), kernels.end(),
                   [](const auto* a, const auto* b) { return a->cycles > b->cycles; });
  kernels.resize(std::min(kernels.size(), kWaitsNamed));
  std::string text;
  const double time = double(statistics.firmware_cycles) * statistics.arrays();
  for (const model::KernelStatistics* const kernel : kernels)
    text += (text.empty() ? "" : ", ") + kernel->name + " " + percent(double(kernel->cycles) / time);
  return text;
}

/// "; the PE array waits for programmed I/O 53.7 % of the time, most before scatter (26.8 %) and append (22.7
/// %)"
std::string waits_for_pio(const ChipStatistics& statistics) {
  const double time = double(statistics.firmware_cycles) * statistics.arrays();
  std::vector<const model::KernelStatistics*> kernels;
  for (const model::KernelStatistics& kernel : statistics.kernels)
    if (kernel.waited_before.total() > 0) kernels.push_back(&kernel);
  std::stable_sort(kernels.begin(), kernels.end(), [](const auto* a, const auto* b) {
    return a->waited_before.total() > b->waited_before.total();
  });
  kernels.resize(std::min(kernels.size(), kWaitsNamed));
  std::string text =
      "; the PE array waits for programmed I/O " + percent(statistics.exposed_pio_share()) + " of the time";
  for (const model::KernelStatistics* const kernel : kernels)
    text += (kernel == kernels.front() ? ", most before " : " and ") + kernel->name + " (" +
            percent(double(kernel->waited_before.total()) / time) + ")";
  return text;
}

std::string reason_of(const ChipStatistics& statistics, const Verdict& verdict) {
  const std::string critical(verdict.critical);
  const double share = verdict.share_of(critical);
  if (share < kBusy)
    return "no unit is busy for more than " + percent(share) + " of the time (" + critical +
           "): they wait for one another" +
           (statistics.exposed_pio_share() > 0 ? waits_for_pio(statistics) : "");
  std::string busy = critical + " is busy " + percent(share) + " of the time";
  if (critical == "pio") return busy + " (" + parts_of_pio(statistics) + ")" + waits_for_pio(statistics);
  if (critical == "pe_array")
    return busy + " (" + longest_kernels(statistics) + "), " + percent(statistics.simd_efficiency()) +
           " of its lanes enabled";
  return busy;
}

}  // namespace

double Verdict::share_of(std::string_view unit) const {
  return std::find_if(units.begin(), units.end(), [&](const UnitUse& use) { return use.name == unit; })
      ->share;
}

Verdict verdict_of(const ChipStatistics& statistics) {
  Verdict verdict;
  verdict.units = uses_of(statistics);
  verdict.critical =
      std::max_element(verdict.units.begin(), verdict.units.end(), [](const UnitUse& a, const UnitUse& b) {
        return a.share < b.share;
      })->name;
  verdict.reason = reason_of(statistics, verdict);
  return verdict;
}

}  // namespace testbench
