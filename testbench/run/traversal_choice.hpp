#pragma once

#include <cstddef>
#include <optional>
#include <set>
#include <string>

#include "firmware/path_tracer/program/program_config.hpp"
#include "model/config/chip_config.hpp"
#include "testbench/scene/scene.hpp"

namespace testbench {

/// How rays find triangles, and why so.
struct TraversalChoice {
  path_tracer::Traversal traversal = path_tracer::Traversal::brute_force;
  std::string reason;  ///< one line
};

/// What the choice depends on of a scene's triangles.
struct TriangleCount {
  std::size_t triangles = 0;
  bool has_layers = false;  ///< their records are longer (firmware/path_tracer/records/records.hpp)

  TriangleCount(std::size_t count, bool in_layers = false) : triangles(count), has_layers(in_layers) {}
  explicit TriangleCount(const Scene& scene)
      : TriangleCount(scene.triangles.size(), scene.coincident_triangles > 0) {}
};

/// What a ray costs in cycles of the chip, by a simple model.
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

/// The values that the user gave, which are not chosen.
struct TreeOverrides {
  std::optional<int> treelet_nodes = {};
  std::optional<int> stack_entries = {};
  std::optional<int> node_width = {};
  std::optional<int> visits = {};
  std::optional<path_tracer::NodeFormat> node_format = {};
};

/// The program's tree with the overrides; the rest suits its traversal and its width.
path_tracer::TreeShape overridden_tree(const path_tracer::ProgramConfig& program,
                                       const TreeOverrides& overrides);

/// The tree that suits the program's traversal of so many triangles, as sweeps/node_width.toml and
/// node_format.toml measured it, but for the overrides. Nodes are wide where triangles are many: their rays
/// make fewer turns, and a turn is what costs most. They are quantised where a ray waits for I/O. A tree that
/// does not fit a PE's SRAM beside everything else gets a shorter stack, then smaller treelets, then narrower
/// nodes, as far as these are not overridden; if none of that helps, the tree stays as the overrides have it.
/// Automatic resident nodes (kAsManyAsFit) count as one while the rest is fitted.
path_tracer::TreeShape tree_that_fits(const TriangleCount& count, const path_tracer::ProgramConfig& program,
                                      const model::ChipConfig& chip, const TreeOverrides& overrides);

/// As many nodes as the SRAM has room for beside everything else, at least one and no more than a tree of so
/// many triangles has.
int resident_nodes_that_fit(const TriangleCount& count, const path_tracer::ProgramConfig& program,
                            const model::ChipConfig& chip);

/// TreeShape::resident_nodes until the scene is known.
inline constexpr int kAsManyAsFit = 0;

/// Replaces kAsManyAsFit by a number.
void complete_traversal(const TriangleCount& count, const model::ChipConfig& chip,
                        path_tracer::ProgramConfig& program);

/// Names of the firmware options that the user gave (program_options.hpp).
using GivenOptions = std::set<std::string>;

/// Chooses every option of the tree that was not given. Has fewer light candidates, unless they were given,
/// where the SRAM has no room for as many. Returns why the traversal was chosen, in a line; ""
/// if it was given. Throws InputError for a program that the firmware refuses.
std::string choose_tree(const TriangleCount& count, const model::ChipConfig& chip, const GivenOptions& given,
                        path_tracer::ProgramConfig& program);

}  // namespace testbench
