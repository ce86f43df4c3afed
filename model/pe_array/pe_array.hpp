#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <systemc>
#include <vector>

#include "firmware/cn/chip/instruction.hpp"
#include "model/config/chip_config.hpp"
#include "model/pe_array/kernel_statistics.hpp"
#include "model/time/cycles.hpp"

namespace model {

/// What kernels cost on the PEs: they run in lock step, so a kernel takes what its instructions take,
/// whatever the data. The lanes' values are computed by the firmware's own code (firmware/cn).
class PeArray : public sc_core::sc_module {
 public:
  PeArray(const sc_core::sc_module_name& name, const ChipConfig& config);

  struct Cost {
    Cycles cycles = 0;       ///< the kernel alone
    Cycles sram_cycles = 0;  ///< those of `cycles` that access SRAM
  };

  /// Books a kernel and returns what it takes. Mono instructions go on beside poly ones through the issue
  /// queue; the longer stream counts. So do vector loads beside vector arithmetic, if the chip overlaps them.
  /// @param waited_before the control unit's waits since the kernel before
  Cost retire(const char* name, const cn::IssueTree& issued, const PioWaits& waited_before = {});

  /// All kernels, in the order in which they first ran.
  std::vector<KernelStatistics> kernels() const;
  KernelStatistics total() const;
  int num_pes() const { return num_pes_; }

 private:
  /// Instructions that a kernel issues one after the other, whatever the data: its cost is computed once.
  struct Block {
    cn::IssueCounts counts;
    double cycles = 0;
    std::uint64_t times = 0;
    std::uint64_t enabled_lanes = 0;  ///< summed over the times that it was issued
  };
  struct Kernel {
    const char* name;             ///< a string literal: compared by address
    KernelStatistics statistics;  ///< all but the sums over blocks
    std::vector<Block> blocks;
    /// Indices of the blocks in the order in which the last run issued them: the next run is likely to do the
    /// same.
    std::vector<std::size_t> order;
  };

  Kernel& kernel(const char* name);
  Block& block(Kernel& kernel, std::size_t place, const cn::IssueCounts& counts);
  double poly_cycles(const cn::IssueCounts& counts) const;

  int num_pes_;
  double code_quality_factor_;
  bool vector_loads_overlap_;
  std::array<double, cn::kInstructionClasses> cycles_;
  std::vector<Kernel> kernels_;
};

}  // namespace model
