#pragma once

#include "firmware/cn/chip/lane_mask.hpp"
#include "firmware/cn/language/control.hpp"
#include "firmware/cn/language/poly_pointer.hpp"

namespace cn {

/// A poly program: a name for statistics and waves, and the entry point for the x86-64 level in use. The
/// control unit does nothing else while it runs. `run` executes it for all PEs of `enabled`, leaves what was
/// issued in `issued`, and does nothing when no PE is enabled.
template <class Arguments>
struct Kernel {
  const char* name = nullptr;
  void (*run)(const Arguments& arguments, PolyMemory& memory, const LaneMask& enabled,
              IssueTree& issued) = nullptr;
};

/// Runs `program(arguments)` strip by strip. The simulator skips strips without an enabled PE; the other
/// strips give the instructions issued, which are the chip's cost.
///
/// Flattened, because a kernel is straight-line vector code: one operator left as a call keeps its operands
/// out of registers and costs a factor of three.
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

/// Returns the kernel that runs `program`, for a table of entry points.
template <class Arguments, void (*program)(const Arguments&)>
constexpr Kernel<Arguments> kernel(const char* name) {
  return {name, &run_strips<Arguments, program>};
}

/// Keeps one condition for each PE beyond the kernel, for the control unit to count or to enable PEs of a
/// transfer. Disabled PEs read as false. `kept` must hold no bits of PEs that the kernel did not run for.
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
