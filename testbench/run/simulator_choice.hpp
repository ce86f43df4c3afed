#pragma once

#include "testbench/run/render.hpp"
#include "testbench/run/traversal_choice.hpp"

namespace testbench {

/// Chooses for a native run what the simulator is fastest with: its own tree, and whatever else of the chip
/// and of the firmware no image depends on. The counters of what goes round in blocks are those of this
/// choice, not of the chip; a chip with another number of PEs than the default keeps it.
/// @param options whose program has the features of its scene (choose_program())
/// @param given options of the firmware, which stay; with the traversal the firmware's search stays, too
/// Returns the choice in a line.
std::string suit_to_simulator(const GivenOptions& given, RenderOptions& options);

}  // namespace testbench
