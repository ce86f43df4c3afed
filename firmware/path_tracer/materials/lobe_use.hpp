#pragma once

#include <array>
#include <vector>

#include "firmware/cn/chip/lane_mask.hpp"
#include "firmware/path_tracer/materials/lobe_table.hpp"
#include "firmware/path_tracer/program/run_counts.hpp"

namespace path_tracer {

/// Which PEs use which lobes in one run of kernel `shade`. An observation of the simulator: the chip has
/// neither these masks nor the instructions that fill them.
struct LobeUse {
  /// By row of kLobeTable: PEs at a hit whose material has the lobe.
  std::array<cn::LaneMask, kLobeTable.size()> wanted;
  /// By LobePart: PEs that ask for the part. The control unit asks all PEs of the block, also those whose
  /// segment missed and which keep the surface of an earlier hit.
  std::array<cn::LaneMask, std::size_t(LobePart::none)> asked;
};

/// Adds a run of the kernel to the counts of all lobes that the program has.
/// @param counts empty, or one of each row of kLobeTable
inline void count_lobes(const LobeUse& use, const Lobes& lobes, bool skips_absent, int num_pes,
                        std::vector<LobeCount>& counts) {
  counts.resize(kLobeTable.size());
  for (std::size_t i = 0; i < kLobeTable.size(); ++i) {
    const LobePart part = kLobeTable[i].part;
    if (!(lobes.*kLobeTable[i].member) || part == LobePart::none) continue;
    const bool is_issued = !skips_absent || part == LobePart::always || use.asked[std::size_t(part)].any();
    if (!is_issued) continue;
    ++counts[i].blocks;
    counts[i].issued_lanes += std::uint64_t(num_pes);
    counts[i].wanted_lanes += std::uint64_t(use.wanted[i].count());
  }
}

}  // namespace path_tracer
