#pragma once

#include <cstdint>

#include "firmware/cn/chip/access_observer.hpp"
#include "firmware/cn/chip/instruction.hpp"
#include "firmware/cn/simd/mask_lanes.hpp"

namespace cn {

/// IssueCounts as a type of its own. No store to poly memory, which is std::uint64_t, can change these
/// counts. So the compiler adds up a kernel's instructions when it compiles the kernel, instead of one by one
/// at run time.
struct StripCounts {
  unsigned long long by_class[kInstructionClasses] = {};
};

/// Whether poly code is built to report its SRAM accesses. That is a separate build, because a test in every
/// access that is hardly ever true took 4 % of a render's instructions: the compiler spills registers around
/// the call.
#if defined(CN_OBSERVED_SRAM)
inline constexpr bool kObservedSram = true;
#else
inline constexpr bool kObservedSram = false;
#endif

/// The strip of PEs that is executing. In Cn, enable bits, PE number and instruction stream are ambient: no
/// syntax names the machine that a statement runs on. So they are ambient here. Only run_strips (kernel.hpp)
/// sets them.
struct Strip {
  StoredMask enabled{};             ///< PEs that take part in assignments
  StripCounts issued;               ///< instructions since the last flush into `node`
  IssueTree* tree = nullptr;        ///< the kernel's
  IssueTree::Node* node = nullptr;  ///< the strip's place in the kernel's control flow
  std::size_t next_region = 0;      ///< ordinal of the next data-dependent region in `node`
  std::uint64_t* words = nullptr;   ///< word w of lane i is at [w * kStripLanes + i] (PolyMemory::strip)
  std::size_t to_next_strip = 0;    ///< stride between strips, in words
  int num_pes = 0;
  int first_pe = 0;
  AccessObserver* observer = nullptr;  ///< of SRAM accesses; null when there is none
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

/// Instructions issued from now on belong to `node`. Only the first strip to pass a node counts its
/// instructions; what later strips count is never read.
inline void enter_node(IssueTree::Node& node) {
  strip.node = &node;
  if (!node.reached) strip.issued = StripCounts{};
}

/// Adds what was issued since the node was entered to the node.
inline void flush_issued() {
  if (strip.node->reached) return;
  for (std::size_t i = 0; i < kInstructionClasses; ++i)
    strip.node->counts.by_class[i] += strip.issued.by_class[i];
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
