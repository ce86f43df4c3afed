#include "model/pe_array/pe_array.hpp"

#include <algorithm>
#include <cmath>

namespace model {
namespace {

constexpr auto kMono = std::size_t(cn::InstructionClass::mono);
constexpr auto kSram = std::size_t(cn::InstructionClass::sram);
constexpr auto kVectorLoad = std::size_t(cn::InstructionClass::sram_vector_load);
constexpr auto kFirstVector = std::size_t(cn::InstructionClass::fp64_add_vector4);
constexpr auto kLastVector = std::size_t(cn::InstructionClass::fp32_multiply_add_vector4);

}  // namespace

PeArray::PeArray(const sc_core::sc_module_name& name, const ChipConfig& config)
    : sc_module(name),
      num_pes_(config.chip.pes),
      code_quality_factor_(config.poly.code_quality_factor),
      vector_loads_overlap_(config.poly.vector_loads_overlap),
      cycles_(config.poly.cycles) {}

double PeArray::poly_cycles(const cn::IssueCounts& counts) const {
  const auto cycles = [&](std::size_t i) { return double(counts.by_class[i]) * cycles_[i]; };
  double sum = 0;
  for (std::size_t i = 0; i < kMono; ++i) sum += cycles(i);
  double vector_arithmetic = 0;
  for (std::size_t i = kFirstVector; i <= kLastVector; ++i) vector_arithmetic += cycles(i);
  return vector_loads_overlap_ ? sum - std::min(cycles(kVectorLoad), vector_arithmetic) : sum;
}

PeArray::Cost PeArray::retire(const char* name, const cn::IssueTree& issued, const PioWaits& waited_before) {
  Kernel& of = kernel(name);
  KernelStatistics& statistics = of.statistics;
  std::uint64_t mono_instructions = 0;
  std::uint64_t sram_words = 0;
  std::uint64_t vector_load_words = 0;
  double issue_cycles = 0;
  std::size_t place = 0;
  issued.for_each_node([&](const cn::IssueTree::Node& node) {
    Block& block = this->block(of, place++, node.counts);
    ++block.times;
    block.enabled_lanes += node.enabled_lanes;
    mono_instructions += block.counts.by_class[kMono];
    sram_words += block.counts.by_class[kSram];
    vector_load_words += block.counts.by_class[kVectorLoad];
    issue_cycles += block.cycles;
    statistics.enabled_lane_cycles += block.cycles * double(node.enabled_lanes);
  });
  const double poly = issue_cycles * code_quality_factor_;
  const double mono = double(mono_instructions) * cycles_[kMono] * code_quality_factor_;
  const double sram =
      (double(sram_words) * cycles_[kSram] + double(vector_load_words) * cycles_[kVectorLoad]) *
      code_quality_factor_;
  const Cost cost{static_cast<Cycles>(std::llround(std::max(poly, mono))),
                  static_cast<Cycles>(std::llround(sram))};
  ++statistics.runs;
  statistics.cycles += cost.cycles;
  statistics.issue_cycles += issue_cycles;
  statistics.waited_before += waited_before;
  ++statistics.runs_by_enabled_pes[std::size_t(issued.root().enabled_lanes)];
  return cost;
}

PeArray::Kernel& PeArray::kernel(const char* name) {
  const auto found = std::find_if(kernels_.begin(), kernels_.end(),
                                  [&](const Kernel& kernel) { return kernel.name == name; });
  if (found != kernels_.end()) return *found;
  kernels_.push_back({name, {}, {}, {}});
  KernelStatistics& statistics = kernels_.back().statistics;
  statistics.name = name;
  statistics.runs_by_enabled_pes.resize(std::size_t(num_pes_) + 1);
  return kernels_.back();
}

/// @param place number of the block among those that this run issues
PeArray::Block& PeArray::block(Kernel& kernel, std::size_t place, const cn::IssueCounts& counts) {
  std::vector<Block>& blocks = kernel.blocks;
  if (place < kernel.order.size()) {
    Block& expected = blocks[kernel.order[place]];
    if (expected.counts == counts) return expected;
  } else {
    kernel.order.resize(place + 1);
  }
  auto found =
      std::find_if(blocks.begin(), blocks.end(), [&](const Block& block) { return block.counts == counts; });
  if (found == blocks.end()) {
    blocks.push_back({counts, poly_cycles(counts)});
    found = blocks.end() - 1;
  }
  kernel.order[place] = std::size_t(found - blocks.begin());
  return *found;
}

std::vector<KernelStatistics> PeArray::kernels() const {
  std::vector<KernelStatistics> kernels;
  for (const Kernel& kernel : kernels_) {
    KernelStatistics& statistics = kernels.emplace_back(kernel.statistics);
    for (const Block& block : kernel.blocks)
      for (std::size_t i = 0; i < cn::kInstructionClasses; ++i) {
        statistics.issued.by_class[i] += block.counts.by_class[i] * block.times;
        statistics.executed.by_class[i] += block.counts.by_class[i] * block.enabled_lanes;
      }
  }
  return kernels;
}

KernelStatistics PeArray::total() const {
  KernelStatistics sum;
  sum.name = "total";
  for (const KernelStatistics& kernel : kernels()) sum += kernel;
  return sum;
}

}  // namespace model
