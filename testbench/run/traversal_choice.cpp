#include "testbench/run/traversal_choice.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "firmware/path_tracer/kernels/kernels.hpp"
#include "firmware/path_tracer/make_tracer.hpp"
#include "firmware/path_tracer/traversals/ray_unit_search.hpp"
#include "model/config/address_map.hpp"
#include "testbench/machine/native_machine.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

using path_tracer::ProgramConfig;
using path_tracer::Traversal;

/// Cycles of a poly program on all PEs.
double cycles_of(const cn::IssueCounts& counts, const model::ChipConfig& chip) {
  double cycles = 0;
  for (std::size_t i = 0; i < cn::kInstructionClasses; ++i)
    if (cn::InstructionClass(i) != cn::InstructionClass::mono)
      cycles += double(counts.by_class[i]) * chip.poly.cycles[i];
  return cycles * chip.poly.code_quality_factor;
}

/// Cycles of the intersect kernel for so many triangles.
double intersect_cycles(int triangles, const model::ChipConfig& chip) {
  constexpr int kPes = 8;
  cn::PolyMemory memory(kPes, 1024);
  const std::vector<path_tracer::TriangleRecord> records(std::size_t(triangles) + 1);
  cn::LaneMask hit;
  path_tracer::IntersectArguments arguments;
  arguments.ray =
      cn::PolyPointer<path_tracer::RayRecord>(memory.allocate("ray", sizeof(path_tracer::RayRecord)));
  arguments.hit =
      cn::PolyPointer<path_tracer::HitRecord>(memory.allocate("hit", sizeof(path_tracer::HitRecord)));
  arguments.surface_place = {memory.allocate("place", sizeof(cn::MonoAddress)).offset_bytes};
  arguments.triangles = records.data();
  arguments.triangle_count = triangles;
  arguments.hit_something = &hit;
  cn::IssueTree issued;
  path_tracer::kernels(cn::widest_level())
      .intersect.run(arguments, memory, cn::LaneMask::first(kPes), issued);
  return cycles_of(issued.total(), chip);
}

/// What a ray visits on its way through the tree, by the number of triangles: measured on `csx600 scene
/// blob`.
struct Visits {
  double leaves;
  double treelets;
  double turns;
};
Visits visits_of_a_ray(std::size_t triangles) {
  const double doublings = std::max(0.0, std::log2(double(std::max<std::size_t>(1, triangles)) / 50));
  return {3.0, 0.25 * doublings, 4.1 + 0.28 * doublings};
}

/// The kernels of a turn take as long as so many triangle tests; the other constant is the share of PEs that
/// have a ray. Both measured as above.
constexpr double kTrianglesOfATurn = 28;
constexpr double kOccupancy = 0.8;

/// Cycles to fetch a triangle when the data cache does not hold all of them from one block to the next.
double fetch_cycles_of_a_triangle(const model::ChipConfig& chip) {
  const double lines = double(sizeof(path_tracer::TriangleRecord)) / chip.control.cache_line_bytes;
  return lines * (chip.control.cache_miss_cycles + chip.ddr.page_miss_cycles +
                  2.0 * chip.clear_connect.hops_to_ddr * chip.clear_connect.hop_cycles +
                  double(chip.control.cache_line_bytes) / chip.clear_connect.bytes_per_cycle);
}

/// Bytes of a PE's SRAM that the program leaves free; negative if it does not fit. Automatic resident nodes
/// count as one. Throws InputError for a program that the firmware refuses.
int bytes_left(const ProgramConfig& program, const model::ChipConfig& chip, bool has_layers) try {
  ProgramConfig least = program;
  if (least.tree.resident_nodes == kAsManyAsFit) least.tree.resident_nodes = 1;
  least.scratchpad = path_tracer::Scratchpad::none;  // takes nothing of a PE's SRAM
  const path_tracer::Layout layout = path_tracer::make_layout({0, 0, 1, has_layers}, chip.chip.pes, least);
  constexpr int kPlenty = 1 << 18;
  NativeMachine machine(chip.chip.pes, kPlenty, layout.total_bytes, {}, model::search_unit_range(chip));
  path_tracer::make_tracer(machine, path_tracer::kernels(cn::widest_level()), least, layout, {});
  return chip.poly.sram_bytes - cn::PolyMemory::kReservedBytes - machine.poly_memory().used_bytes();
} catch (const cn::PolyMemoryOverflow&) {
  return -1;  // beyond any SRAM
} catch (const path_tracer::ProgramError& error) {
  throw InputError(error.what());
}

/// Whether eight children a node cost less than four. Packets make no turns: four are best.
bool suits_wide_nodes(const ProgramConfig& program, std::size_t triangles) {
  return !program.uses_packets() && triangles >= 5000;
}

/// Rays that wait for I/O do best with the fewest bytes, rays that wait for kernels with the boxes that are
/// decoded fastest.
path_tracer::NodeFormat suited_format(const ProgramConfig& program, int width) {
  const bool waits_for_kernels = program.traversal == Traversal::lock_step || program.uses_packets();
  const path_tracer::NodeLayout quantised{path_tracer::NodeFormat::quantised8, width};
  return waits_for_kernels || !quantised.has_kernel() ? path_tracer::NodeFormat::fp32 : quantised.format;
}

/// More visits a turn pay where a node is visited fast and another turn costs much.
int suited_visits(Traversal traversal, const path_tracer::NodeLayout& layout) {
  const bool is_fast = layout.format == path_tracer::NodeFormat::fp32;
  switch (traversal) {
    case Traversal::lock_step:
      return layout.width == 2 ? 3 : 2;
    case Traversal::refill:
      return layout.width == 8 ? (is_fast ? 3 : 2) : (is_fast || layout.width == 2 ? 6 : 3);
    default:
      return layout.width == 8 ? 3 : layout.width == 4 ? 6 : 8;
  }
}

path_tracer::TreeShape suited_tree(int width, const ProgramConfig& of, const TreeOverrides& overrides) {
  constexpr int kTreeletChildren = 8;
  path_tracer::TreeShape tree = of.tree;
  tree.layout.width = width;
  tree.layout.format = overrides.node_format.value_or(suited_format(of, width));
  tree.treelet_nodes = overrides.treelet_nodes.value_or(kTreeletChildren / width);
  tree.stack_entries = overrides.stack_entries.value_or(tree.stack_entries);
  tree.visits = overrides.visits.value_or(suited_visits(of.traversal, tree.layout));
  return tree;
}

/// The program's tree with a shorter stack, then with smaller treelets; none if that does not fit either.
std::optional<path_tracer::TreeShape> shrunk_to_fit(const ProgramConfig& program,
                                                    const model::ChipConfig& chip,
                                                    const TreeOverrides& overrides, bool has_layers) {
  // Segments a second by the temporary bin, 100,000 triangles: 159 k with treelets of 2 nodes and 2 entries,
  // 152 k with 1 node and 8 entries, 138 k with 2 nodes and 1 entry.
  constexpr int kFewEntries = 2;
  ProgramConfig fitting = program;
  path_tracer::TreeShape& tree = fitting.tree;
  for (;; tree.treelet_nodes /= 2) {
    const bool is_least_treelet = tree.treelet_nodes <= 1 || overrides.treelet_nodes.has_value();
    const int least_entries = is_least_treelet ? 0 : kFewEntries;
    for (tree.stack_entries = program.tree.stack_entries;; tree.stack_entries /= 2) {
      if (bytes_left(fitting, chip, has_layers) >= 0) return tree;
      if (tree.stack_entries <= least_entries || overrides.stack_entries.has_value()) break;
    }
    if (is_least_treelet) return {};
  }
}

/// As many blocks as make a packet or stream fastest, or half as many until they fit beside the least tree.
/// Measured in blobs of 10,000 triangles: large packets of 1, 2, 4, 8, 16 blocks took 1374, 1305, 1260, 1318,
/// 1526 cycles a camera ray, streams 1361, 1188, 999, 921, 884.
void choose_packet_blocks(const TriangleCount& count, const model::ChipConfig& chip, ProgramConfig& program) {
  if (program.traversal != Traversal::large_packets && program.traversal != Traversal::ray_streams) return;
  program.packet_blocks = program.traversal == Traversal::large_packets ? 4 : path_tracer::kMaxPacketBlocks;
  while (program.packet_blocks > 1 && bytes_left(program, chip, count.has_layers) < 0)
    program.packet_blocks /= 2;
}

std::string rounded(double cycles) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.0f", cycles);
  return text;
}

/// Bins of the default length become shorter where the unit's buffer holds fewer rays.
void fit_bins_to_unit(const model::ChipConfig& chip, ProgramConfig& program) {
  const int most = path_tracer::RayUnitSearch::most_bin_blocks(
      model::search_unit_range(chip), path_tracer::RecordSizes(program.features), chip.chip.pes);
  program.bin_blocks = std::clamp(most, std::max(1, program.n), std::max(program.n, program.bin_blocks));
}

TreeOverrides overrides_of(const ProgramConfig& program, const GivenOptions& given) {
  const path_tracer::TreeShape& tree = program.tree;
  TreeOverrides overrides;
  if (given.count("treelet_nodes") != 0) overrides.treelet_nodes = tree.treelet_nodes;
  if (given.count("stack_entries") != 0) overrides.stack_entries = tree.stack_entries;
  if (given.count("node_width") != 0) overrides.node_width = tree.layout.width;
  if (given.count("visits") != 0) overrides.visits = tree.visits;
  if (given.count("node_format") != 0) overrides.node_format = tree.layout.format;
  return overrides;
}

}  // namespace

TraversalCosts estimate_traversal(std::size_t triangles, const path_tracer::TreeShape& tree,
                                  const model::ChipConfig& chip) {
  const double pes = chip.chip.pes;
  TraversalCosts costs;
  const double triangle_cycles = intersect_cycles(1, chip) - intersect_cycles(0, chip);
  const double bytes = double(triangles) * sizeof(path_tracer::TriangleRecord);
  const double fetch_cycles = bytes > chip.control.data_cache_bytes ? fetch_cycles_of_a_triangle(chip) : 0;
  costs.brute_force = (triangle_cycles + fetch_cycles) * double(triangles) / pes;
  const Visits visits = visits_of_a_ray(triangles);
  const auto request = [&](double of_bytes) {
    return chip.pio.per_pe_cycles + of_bytes / chip.pio.bytes_per_cycle;
  };
  const double leaf_bytes = double(tree.leaf_records()) * sizeof(path_tracer::TriangleRecord);
  const double pio = visits.leaves * request(leaf_bytes) + visits.treelets * request(tree.treelet_bytes()) +
                     2 * request(sizeof(path_tracer::QueuedRay)) + request(sizeof(path_tracer::HitRecord)) +
                     request(sizeof(cn::MonoAddress));
  const double kernels = visits.turns * kTrianglesOfATurn * triangle_cycles / (pes * kOccupancy);
  costs.tree = std::max(pio, kernels);
  return costs;
}

TraversalChoice choose_traversal(std::size_t triangles, const path_tracer::TreeShape& tree,
                                 const model::ChipConfig& chip) {
  const TraversalCosts costs = estimate_traversal(triangles, tree, chip);
  const bool uses_tree = costs.tree < costs.brute_force;
  return {uses_tree ? Traversal::refill : Traversal::brute_force,
          std::to_string(triangles) + " triangles: about " + rounded(costs.brute_force) +
              " cycles a ray by brute force, " + rounded(costs.tree) + " with a tree"};
}

path_tracer::TreeShape overridden_tree(const ProgramConfig& program, const TreeOverrides& overrides) {
  return suited_tree(overrides.node_width.value_or(program.tree.layout.width), program, overrides);
}

path_tracer::TreeShape tree_that_fits(const TriangleCount& count, const ProgramConfig& program,
                                      const model::ChipConfig& chip, const TreeOverrides& overrides) {
  ProgramConfig suited = program;
  if (!overrides.node_width && suits_wide_nodes(program, count.triangles)) {
    suited.tree = suited_tree(path_tracer::kMaxNodeWidth, program, overrides);
    if (const auto fitting = shrunk_to_fit(suited, chip, overrides, count.has_layers)) return *fitting;
  }
  suited.tree = overridden_tree(program, overrides);
  return shrunk_to_fit(suited, chip, overrides, count.has_layers).value_or(suited.tree);
}

int resident_nodes_that_fit(const TriangleCount& count, const ProgramConfig& program,
                            const model::ChipConfig& chip) {
  ProgramConfig least = program;
  least.tree.resident_nodes = 1;
  const int left = bytes_left(least, chip, count.has_layers);
  const auto nodes_of_tree =
      static_cast<int>(std::min<std::size_t>(count.triangles, path_tracer::kMaxTreeletNodes));
  return std::clamp(1 + left / program.tree.layout.node_bytes(), 1, std::max(1, nodes_of_tree));
}

void complete_traversal(const TriangleCount& count, const model::ChipConfig& chip, ProgramConfig& program) {
  if (!program.uses_tree() || program.tree.resident_nodes != kAsManyAsFit) return;
  if (program.hands_rays_to_unit()) {
    program.tree.resident_nodes = 1;  // no PE has any
    return;
  }
  program.tree.resident_nodes = resident_nodes_that_fit(count, program, chip);
}

std::string choose_tree(const TriangleCount& count, const model::ChipConfig& chip, const GivenOptions& given,
                        ProgramConfig& program) {
  const TreeOverrides overrides = overrides_of(program, given);
  if (given.count("resident_nodes") == 0) program.tree.resident_nodes = kAsManyAsFit;
  program.tree = overridden_tree(program, overrides);
  std::string reason;
  if (given.count("traversal") == 0 && program.is_stream()) {
    program.traversal = Traversal::brute_force;
    reason = "execution stream has no tree";
  } else if (given.count("traversal") == 0 && program.keeps_paths_in_sram()) {
    program.traversal = Traversal::brute_force;
    reason = "resident_paths: the whole scene is in each PE's SRAM";
  } else if (given.count("traversal") == 0) {
    const TraversalChoice choice = choose_traversal(count.triangles, program.tree, chip);
    program.traversal = choice.traversal;
    reason = choice.reason;
  }
  if (given.count("packet_blocks") == 0) choose_packet_blocks(count, chip, program);
  if (program.hands_rays_to_unit() && given.count("bin_blocks") == 0) fit_bins_to_unit(chip, program);
  const path_tracer::TreeShape whole = program.tree;
  const auto fit_tree = [&] {
    if (!program.uses_tree()) return;
    program.tree = whole;
    program.tree = tree_that_fits(count, program, chip, overrides);
  };
  fit_tree();
  while (program.light_candidates > 1 && given.count("light_candidates") == 0 &&
         bytes_left(program, chip, count.has_layers) < 0) {
    program.light_candidates /= 2;
    fit_tree();
  }
  complete_traversal(count, chip, program);
  return reason;
}

}  // namespace testbench
