#pragma once

#include "firmware/cn/chip/lane_mask.hpp"
#include "firmware/cn/language/control.hpp"
#include "firmware/cn/language/poly_pointer.hpp"

namespace cn {

/// A poly program between two points at which the control unit does something else: a name for statistics and
/// waves, and the entry point of the x86-64 level in use. `run` executes it for all PEs that `enabled` names,
/// leaves what was issued in `issued`, and runs nothing when no PE is enabled.
template <class Arguments>
struct Kernel {
  const char* name = nullptr;
  void (*run)(const Arguments& arguments, PolyMemory& memory, const LaneMask& enabled,
              IssueTree& issued) = nullptr;
};

/// Runs `program(arguments)` strip by strip. Strips without an enabled PE are skipped by the host; the chip's
/// cost is that of the instructions issued, which the other strips give.
///
/// Flattened: a kernel is straight-line vector code; one operator left as a call keeps its operands out of
/// registers and costs a factor of three.
template <class Arguments, void (*program)(const Arguments&)>
[[gnu::flatten]] void run_strips(const Arguments& arguments, PolyMemory& memory, const LaneMask& enabled,
                                 IssueTree& issued) {
  issued.clear();
  strip.to_next_strip = memory.strip_words();
  strip.num_pes = memory.num_pes();
  strip.observer = memory.observer();
  if (!kObservedSram && memory.observer() != nullptr) memory.observer()->kernel_is_silent();
  for (int first_pe = 0; first_pe < memory.num_pes(); first_pe += kStripLanes) {
    const std::uint8_t bits = enabled.strip_bits(first_pe / kStripLanes);
    if (bits == 0) continue;
    strip.first_pe = first_pe;
    strip.words = memory.strip(first_pe);
    strip.enabled = mask_from_bits(bits);
    strip.tree = &issued;
    enter_node(issued.root());
    strip.next_region = 0;
    issued.root().enabled_lanes += static_cast<std::uint64_t>(__builtin_popcount(bits));
    program(arguments);
    flush_issued();
    issued.root().reached = true;
  }
}

/// The kernel that runs `program`, for a table of entry points.
template <class Arguments, void (*program)(const Arguments&)>
constexpr Kernel<Arguments> kernel(const char* name) {
  return {name, &run_strips<Arguments, program>};
}

/// Keeps one condition a PE beyond the kernel, for the control unit to count or to enable PEs of a transfer
/// by. PEs that are not enabled read as false. `kept` must hold no bits of PEs that the kernel did not run
/// for.
inline void keep(const mask& condition, LaneMask& kept) {
  issue(InstructionClass::sram);
  kept.set_strip_bits(strip.first_pe / kStripLanes, mask_bits(condition.lanes()) & mask_bits(strip.enabled));
}

/// Reads back what `keep` kept.
inline mask recall(const LaneMask& kept) {
  issue(InstructionClass::sram);
  return mask(mask_from_bits(kept.strip_bits(strip.first_pe / kStripLanes)));
}

}  // namespace cn
