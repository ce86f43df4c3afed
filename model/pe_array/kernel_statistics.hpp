#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "firmware/cn/chip/instruction.hpp"
#include "model/time/cycles.hpp"

namespace model {

/// Cycles in which the control unit did nothing but wait for programmed I/O.
struct PioWaits {
  Cycles load = 0;   ///< blocked on a semaphore of a mono-to-poly transfer
  Cycles save = 0;   ///< blocked on a semaphore of a poly-to-mono transfer
  Cycles queue = 0;  ///< blocked before a full queue

  Cycles total() const { return load + save + queue; }
  PioWaits& operator+=(const PioWaits& other) {
    load += other.load, save += other.save, queue += other.queue;
    return *this;
  }
  PioWaits operator-(const PioWaits& other) const {
    return {load - other.load, save - other.save, queue - other.queue};
  }
};

struct KernelStatistics {
  std::string name;
  std::uint64_t runs = 0;
  Cycles cycles = 0;
  cn::IssueCounts issued;
  cn::IssueCounts executed;  ///< issued, each weighted by the PEs enabled
  PioWaits waited_before;    ///< since the kernel that ran before, whichever it was
  /// [e]: runs that began with e PEs enabled.
  std::vector<std::uint64_t> runs_by_enabled_pes;
  double issue_cycles = 0;         ///< before the code quality factor
  double enabled_lane_cycles = 0;  ///< issue_cycles, each weighted by the PEs enabled

  /// Adds another kernel's numbers, or the same kernel's on another array; the name stays.
  KernelStatistics& operator+=(const KernelStatistics& other) {
    runs += other.runs, cycles += other.cycles;
    issued += other.issued, executed += other.executed;
    waited_before += other.waited_before;
    if (runs_by_enabled_pes.size() < other.runs_by_enabled_pes.size())
      runs_by_enabled_pes.resize(other.runs_by_enabled_pes.size());
    for (std::size_t pes = 0; pes < other.runs_by_enabled_pes.size(); ++pes)
      runs_by_enabled_pes[pes] += other.runs_by_enabled_pes[pes];
    issue_cycles += other.issue_cycles, enabled_lane_cycles += other.enabled_lane_cycles;
    return *this;
  }

  /// Share of the issued lane-cycles in which a PE was enabled. Counts PEs as the kernel, its loops and its
  /// any-branches were entered; the branches of a plain poly if are not told apart.
  double simd_efficiency(int num_pes) const {
    return issue_cycles > 0 ? enabled_lane_cycles / (issue_cycles * num_pes) : 1.0;
  }
};

}  // namespace model
