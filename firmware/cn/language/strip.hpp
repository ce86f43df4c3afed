#pragma once

#include <cstdint>

#include "firmware/cn/chip/access_observer.hpp"
#include "firmware/cn/chip/instruction.hpp"
#include "firmware/cn/simd/mask_lanes.hpp"

namespace cn {

/// IssueCounts in a type of their own: no store to poly memory, which is std::uint64_t, can change these, so
/// the compiler adds up a kernel's instructions when it compiles it instead of one by one when it runs.
struct StripCounts {
  unsigned long long by_class[kInstructionClasses] = {};
};

/// Whether poly code is built to report its SRAM accesses. A build of its own, because a test in every access
/// that is hardly ever true was 4 % of a render's instructions: registers are spilled around the call.
#if defined(CN_OBSERVED_SRAM)
inline constexpr bool kObservedSram = true;
#else
inline constexpr bool kObservedSram = false;
#endif

/// The strip of PEs that is executing. Cn has no syntax for the machine a statement runs on: enable bits, PE
/// number and the instruction stream are ambient there, and so they are here. Set only by run_strips
/// (kernel.hpp).
struct Strip {
  StoredMask enabled{};             ///< PEs that take part in assignments
  StripCounts issued;               ///< instructions since the last flush into `node`
  IssueTree* tree = nullptr;        ///< of the kernel
  IssueTree::Node* node = nullptr;  ///< where in the kernel's control flow the strip is
  std::size_t next_region = 0;      ///< ordinal of the next data-dependent region in `node`
  std::uint64_t* words = nullptr;   ///< word w of lane i is at [w * kStripLanes + i] (PolyMemory::strip)
  std::size_t to_next_strip = 0;    ///< words
  int num_pes = 0;
  int first_pe = 0;
  AccessObserver* observer = nullptr;  ///< of the SRAM; null when nobody looks
};

inline thread_local Strip strip;

inline void issue(InstructionClass instruction, std::uint64_t times = 1) {
  strip.issued.by_class[static_cast<std::size_t>(instruction)] += times;
}

/// Tells the observer, if there is one, that the enabled PEs touch these bytes of their SRAM.
inline void observe_sram(Access access, PolySpan bytes) {
  if constexpr (kObservedSram)
    if (strip.observer != nullptr)
      strip.observer->touches_poly(access, bytes, strip.first_pe, mask_bits(strip.enabled));
}

/// From here on instructions belong to `node`. Only the first strip to pass a node counts its instructions;
/// the others leave behind what nobody reads.
inline void enter_node(IssueTree::Node& node) {
  strip.node = &node;
  if (!node.reached) strip.issued = StripCounts{};
}

/// Books what was issued since the node was entered.
inline void flush_issued() {
  if (strip.node->reached) return;
  for (std::size_t i = 0; i < kInstructionClasses; ++i)
    strip.node->counts.by_class[i] += strip.issued.by_class[i];
}

/// Whether another strip was here before, so that what this one issues is known.
inline bool issue_is_known() {
  return strip.node->reached;
}

/// Runs `body` and issues what it issues so many times. It enters no data-dependent region.
template <class Body>
inline void issue_times(std::uint64_t times, Body&& body) {
  const StripCounts before = strip.issued;
  body();
  for (std::size_t i = 0; i < kInstructionClasses; ++i)
    strip.issued.by_class[i] = before.by_class[i] + times * (strip.issued.by_class[i] - before.by_class[i]);
}

/// Runs `body` for what it computes: what the PEs do for it is issued elsewhere.
template <class Body>
inline void issue_nothing(Body&& body) {
  const StripCounts before = strip.issued;
  body();
  strip.issued = before;
}

/// Runs `body` as the given iteration of a data-dependent region of the current node.
template <class Body>
inline void run_node(std::size_t region, std::size_t iteration, Body&& body) {
  IssueTree::Node& parent = *strip.node;
  const std::size_t parent_next_region = strip.next_region;
  flush_issued();
  IssueTree::Node& node = strip.tree->node(parent, region, iteration);
  node.enabled_lanes += static_cast<std::uint64_t>(__builtin_popcount(mask_bits(strip.enabled)));
  enter_node(node);
  strip.next_region = 0;
  body();
  flush_issued();
  node.reached = true;
  enter_node(parent);
  strip.next_region = parent_next_region;
}

}  // namespace cn
