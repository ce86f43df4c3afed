#include "model/pe_array.hpp"

#include <algorithm>
#include <cmath>

namespace model {
namespace {

constexpr auto kMono = std::size_t(cn::InstructionClass::mono);
constexpr auto kSram = std::size_t(cn::InstructionClass::sram);
constexpr auto kVectorLoad = std::size_t(cn::InstructionClass::sram_vector_load);
constexpr auto kFirstVector = std::size_t(cn::InstructionClass::fp64_add_vector4);
constexpr auto kLastVector = std::size_t(cn::InstructionClass::fp32_multiply_add_vector4);

// A kernel issues far fewer instructions than 2^31, and x86-64 converts and multiplies numbers of 32 bits
// several at a time.
double as_double(std::uint64_t instructions) {
  return double(static_cast<std::int32_t>(instructions));
}
std::uint64_t times_lanes(std::uint64_t instructions, std::uint64_t lanes) {
  return std::uint64_t{static_cast<std::uint32_t>(instructions)} * static_cast<std::uint32_t>(lanes);
}

}  // namespace

PeArray::PeArray(const sc_core::sc_module_name& name, const ChipConfig& config)
    : sc_module(name),
      num_pes_(config.chip.pes),
      code_quality_factor_(config.poly.code_quality_factor),
      vector_loads_overlap_(config.poly.vector_loads_overlap),
      cycles_(config.poly.cycles) {}

double PeArray::poly_cycles(const cn::IssueCounts& counts) const {
  // Four sums side by side: one would make each addition wait for the one before.
  constexpr std::size_t kSums = 4;
  static_assert(kMono % kSums == 0);
  double sums[kSums] = {};
  for (std::size_t i = 0; i < kMono; i += kSums)
    for (std::size_t k = 0; k < kSums; ++k) sums[k] += as_double(counts.by_class[i + k]) * cycles_[i + k];
  const double sum = (sums[0] + sums[1]) + (sums[2] + sums[3]);
  double vector_arithmetic = 0;
  for (std::size_t i = kFirstVector; i <= kLastVector; ++i)
    vector_arithmetic += as_double(counts.by_class[i]) * cycles_[i];
  const double vector_loads = as_double(counts.by_class[kVectorLoad]) * cycles_[kVectorLoad];
  return vector_loads_overlap_ ? sum - std::min(vector_loads, vector_arithmetic) : sum;
}

PeArray::Cost PeArray::retire(const char* kernel, const cn::IssueTree& issued,
                              const PioWaits& waited_before) {
  KernelStatistics& statistics = entry(kernel);
  cn::IssueCounts counts;
  double issue_cycles = 0;
  issued.for_each_node([&](const cn::IssueTree::Node& node) {
    const double node_cycles = poly_cycles(node.counts);
    counts += node.counts;
    issue_cycles += node_cycles;
    statistics.enabled_lane_cycles += node_cycles * double(node.enabled_lanes);
    for (std::size_t i = 0; i < cn::kInstructionClasses; ++i)
      statistics.executed.by_class[i] += times_lanes(node.counts.by_class[i], node.enabled_lanes);
  });
  const double poly = issue_cycles * code_quality_factor_;
  const double mono = double(counts.by_class[kMono]) * cycles_[kMono] * code_quality_factor_;
  const double sram = (double(counts.by_class[kSram]) * cycles_[kSram] +
                       double(counts.by_class[kVectorLoad]) * cycles_[kVectorLoad]) *
                      code_quality_factor_;
  const Cost cost{static_cast<Cycles>(std::llround(std::max(poly, mono))),
                  static_cast<Cycles>(std::llround(sram))};
  ++statistics.runs;
  statistics.cycles += cost.cycles;
  statistics.issued += counts;
  statistics.issue_cycles += issue_cycles;
  statistics.waited_before += waited_before;
  ++statistics.runs_by_enabled_pes[std::size_t(issued.root().enabled_lanes)];
  return cost;
}

KernelStatistics& PeArray::entry(const char* kernel) {
  const auto found = std::find(names_.begin(), names_.end(), kernel);
  if (found != names_.end()) return kernels_[std::size_t(found - names_.begin())];
  names_.push_back(kernel);
  kernels_.push_back({});
  kernels_.back().name = kernel;
  kernels_.back().runs_by_enabled_pes.resize(std::size_t(num_pes_) + 1);
  return kernels_.back();
}

KernelStatistics PeArray::total() const {
  KernelStatistics sum;
  sum.name = "total";
  for (const KernelStatistics& kernel : kernels_) {
    sum.runs += kernel.runs;
    sum.cycles += kernel.cycles;
    sum.issued += kernel.issued;
    sum.executed += kernel.executed;
    sum.waited_before += kernel.waited_before;
    sum.issue_cycles += kernel.issue_cycles;
    sum.enabled_lane_cycles += kernel.enabled_lane_cycles;
  }
  return sum;
}

}  // namespace model
