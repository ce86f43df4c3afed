#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "firmware/path_tracer/program/program.hpp"
#include "model/config/chip_config.hpp"

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
/// showed (docs/results/real-scenes.md).
TraversalCosts estimate_traversal(std::size_t triangles, const path_tracer::TreeShape& tree,
                                  const model::ChipConfig& chip);

/// Whichever costs less.
TraversalChoice choose_traversal(std::size_t triangles, const path_tracer::TreeShape& tree,
                                 const model::ChipConfig& chip);

/// What the user asked for, which is left alone.
struct TreeWishes {
  std::optional<int> treelet_nodes = {};
  std::optional<int> stack_entries = {};
  std::optional<int> node_width = {};
  std::optional<int> visits = {};
  std::optional<path_tracer::NodeFormat> node_format = {};
};

/// The program's tree with the wishes, and what suits its way and their width.
path_tracer::TreeShape wished_tree(const path_tracer::ProgramConfig& program, const TreeWishes& wishes);

/// The program's tree with what suits its way through so many triangles, as sweeps/node_width.toml and
/// node_format.toml measured it, but for the wishes. Wide nodes: rays of many triangles go round less often,
/// and to go round is what costs most. Quantised ones where I/O is what a ray waits for. Where that does not
/// fit a PE's SRAM beside everything else, a shorter stack, then smaller treelets, then narrower nodes, as
/// far as none was wished for; when that does not help, what was wished for. Of resident nodes, if they are
/// as many as fit, one counts.
path_tracer::TreeShape tree_that_fits(std::size_t triangles, const path_tracer::ProgramConfig& program,
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

/// Both: gives the program, if it uses a tree, one that fits and as many resident nodes.
void fit_tree(std::size_t triangles, const model::ChipConfig& chip, const TreeWishes& wishes,
              path_tracer::ProgramConfig& program);

}  // namespace testbench
