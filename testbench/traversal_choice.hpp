#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "firmware/path_tracer/program.hpp"
#include "model/chip_config.hpp"

namespace testbench {

/// A way through a scene, and why.
struct TraversalChoice {
  path_tracer::Traversal traversal = path_tracer::Traversal::brute_force;
  std::string reason;  ///< one line
};

/// What a ray costs, in cycles of the chip, as far as a simple model tells.
struct TraversalCosts {
  double brute_force = 0;
  double tree = 0;  ///< with refill
};

/// Brute force: what the intersect kernel issues for a triangle. With a tree: its PIO requests or its
/// kernels, whichever takes longer, with as many leaves, treelets and nodes a ray as the generated scenes
/// showed (README, "Real scenes").
TraversalCosts estimate_traversal(std::size_t triangles, const path_tracer::TreeShape& tree,
                                  const model::ChipConfig& chip);

/// Whichever costs less.
TraversalChoice choose_traversal(std::size_t triangles, const path_tracer::TreeShape& tree,
                                 const model::ChipConfig& chip);

/// What the user asked for, which is left alone.
struct TreeWishes {
  std::optional<int> treelet_nodes;
  std::optional<int> stack_entries;
};

/// The program's tree, which follows the wishes. Where it does not fit a PE's SRAM beside everything else, a
/// shorter stack and then smaller treelets, as far as neither was wished for; as it was when that does not
/// help. Of resident nodes, if they are as many as fit, one counts.
path_tracer::TreeShape tree_that_fits(const path_tracer::ProgramConfig& program,
                                      const model::ChipConfig& chip, const TreeWishes& wishes);

/// As many nodes as the SRAM has room for beside everything else, at least one and no more than a tree of so
/// many triangles has.
int resident_nodes_that_fit(std::size_t triangles, const path_tracer::ProgramConfig& program,
                            const model::ChipConfig& chip);

/// For TreeShape::resident_nodes, until the scene is known.
inline constexpr int kAsManyAsFit = 0;

/// Puts a number in the place of kAsManyAsFit.
void complete_traversal(std::size_t triangles, const model::ChipConfig& chip,
                        path_tracer::ProgramConfig& program);

}  // namespace testbench
