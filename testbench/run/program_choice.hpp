#pragma once

#include <array>
#include <string>

#include "testbench/run/traversal_choice.hpp"

namespace testbench {

/// The options that choose_program() may choose.
inline constexpr std::array<const char*, 10> kChosenOptions = {
    "light_candidates", "estimator",      "traversal", "node_format",   "node_width",
    "treelet_nodes",    "resident_nodes", "visits",    "stack_entries", "packet_blocks"};

/// Chooses every option of the firmware that depends on the scene and was not given, as `render` does: how
/// many lights a vertex has to choose from, the estimator, the way to find hits and its tree.
/// @param program with the values of those that were given
/// Returns why the traversal was chosen, in a line; "" if it was given. Throws InputError as choose_tree()
/// does.
std::string choose_program(const Scene& scene, const model::ChipConfig& chip, const GivenOptions& given,
                           path_tracer::ProgramConfig& program);

}  // namespace testbench
