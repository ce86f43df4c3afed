#include "testbench/run/traversal_choice.hpp"

#include <gtest/gtest.h>

#include "firmware/cn/machine.hpp"
#include "firmware/path_tracer/path_tracer.hpp"
#include "model/config/chip_presets.hpp"
#include "testbench/machine/native_machine.hpp"

namespace traversal_choice_test {

using path_tracer::ProgramConfig;
using path_tracer::Traversal;
using path_tracer::TreeShape;
using testbench::choose_traversal;
using testbench::estimate_traversal;

const model::ChipConfig kChip = model::preset("csx600");

TEST(TraversalChoice, ABoxDoesNotPayForATreeAndAMeshDoes) {
  EXPECT_EQ(choose_traversal(1, TreeShape{}, kChip).traversal, Traversal::brute_force);
  EXPECT_EQ(choose_traversal(36, TreeShape{}, kChip).traversal, Traversal::brute_force);
  EXPECT_EQ(choose_traversal(1000, TreeShape{}, kChip).traversal, Traversal::refill);
  EXPECT_EQ(choose_traversal(10000000, TreeShape{}, kChip).traversal, Traversal::refill);
}

TEST(TraversalChoice, SaysWhy) {
  const std::string reason = choose_traversal(1000, TreeShape{}, kChip).reason;
  EXPECT_EQ(reason.find("1000 triangles: about "), 0u) << reason;
  EXPECT_NE(reason.find("by brute force"), std::string::npos) << reason;
}

TEST(TraversalChoice, CostsGrowWithTheScene) {
  testbench::TraversalCosts before = estimate_traversal(1, TreeShape{}, kChip);
  for (std::size_t triangles = 2; triangles < 20000000; triangles *= 2) {
    const testbench::TraversalCosts costs = estimate_traversal(triangles, TreeShape{}, kChip);
    EXPECT_GT(costs.brute_force, before.brute_force);
    EXPECT_GE(costs.tree, before.tree);
    before = costs;
  }
}

/// The tree depends on programmed I/O, brute force on the mono data cache.
TEST(TraversalChoice, FollowsTheChip) {
  model::ChipConfig slow_io = kChip;
  slow_io.pio.per_pe_cycles = 400;
  EXPECT_GT(estimate_traversal(100, TreeShape{}, slow_io).tree,
            3 * estimate_traversal(100, TreeShape{}, kChip).tree);
  EXPECT_EQ(choose_traversal(200, TreeShape{}, kChip).traversal, Traversal::refill);
  EXPECT_EQ(choose_traversal(200, TreeShape{}, slow_io).traversal, Traversal::brute_force);
}

/// Whether the program fits the SRAM of the chip's PEs.
bool fits(const ProgramConfig& program, bool has_layers = false) {
  const path_tracer::Layout layout =
      path_tracer::make_layout({0, 0, 64, has_layers}, kChip.chip.pes, program);
  testbench::NativeMachine machine(kChip.chip.pes, kChip.poly.sram_bytes, layout.total_bytes);
  try {
    path_tracer::PathTracer(machine, path_tracer::kernels(cn::narrowest_level()), program, layout, {});
  } catch (const std::exception&) {
    return false;
  }
  return true;
}

TEST(ResidentNodes, AreAsManyAsFit) {
  for (const Traversal traversal : {Traversal::temporary_bin, Traversal::refill, Traversal::packets})
    for (const int n : {0, 1}) {
      ProgramConfig program;
      program.traversal = traversal;
      program.n = n;
      program.tree.resident_nodes = testbench::kAsManyAsFit;
      testbench::complete_traversal(1000000, kChip, program);
      EXPECT_GT(program.tree.resident_nodes, 1);
      EXPECT_TRUE(fits(program)) << program.tree.resident_nodes;
      ++program.tree.resident_nodes;
      EXPECT_FALSE(fits(program)) << program.tree.resident_nodes;
    }
}

/// Records of layered scenes are longer, so fewer nodes fit beside a leaf.
TEST(ResidentNodes, AreFewerInALayeredScene) {
  ProgramConfig program;
  program.traversal = Traversal::refill;
  const int in_layers = testbench::resident_nodes_that_fit({1000000, true}, program, kChip);
  EXPECT_LT(in_layers, testbench::resident_nodes_that_fit(1000000, program, kChip));
  program.tree.resident_nodes = in_layers;
  EXPECT_TRUE(fits(program, true));
  ++program.tree.resident_nodes;
  EXPECT_FALSE(fits(program, true));
}

/// `program` with its tree reduced until it fits.
ProgramConfig fitted(ProgramConfig program, const testbench::TreeOverrides& overrides = {},
                     std::size_t triangles = 1000) {
  program.tree = testbench::tree_that_fits(triangles, program, kChip, overrides);
  return program;
}

TEST(TreeThatFits, IsTheSuitedOneIfThatFits) {
  for (const Traversal traversal : {Traversal::temporary_bin, Traversal::refill, Traversal::packets}) {
    ProgramConfig program;
    program.traversal = traversal;
    const ProgramConfig same = fitted(program);
    EXPECT_EQ(same.tree.stack_entries, program.tree.stack_entries);
    EXPECT_EQ(same.tree.treelet_nodes, program.tree.treelet_nodes);
  }
}

TEST(TreeThatFits, HasAShorterStackThenSmallerTreelets) {
  ProgramConfig program;
  program.traversal = Traversal::temporary_bin;
  program.tree.resident_nodes = 1;
  program.n = 2;
  testbench::TreeOverrides floats;
  floats.node_format = path_tracer::NodeFormat::fp32;
  testbench::TreeOverrides treelets_of_four = floats;
  treelets_of_four.treelet_nodes = 4;
  const ProgramConfig shorter = fitted(program, treelets_of_four);
  EXPECT_EQ(shorter.tree.treelet_nodes, 4);
  EXPECT_LT(shorter.tree.stack_entries, program.tree.stack_entries);
  EXPECT_TRUE(fits(shorter));
  ProgramConfig longer = shorter;
  longer.tree.stack_entries *= 2;
  EXPECT_FALSE(fits(longer)) << longer.tree.stack_entries;

  program.n = 3;  // needs ten buffers of ray records
  ASSERT_FALSE(fits(program));
  const ProgramConfig smaller = fitted(program, floats);
  EXPECT_TRUE(fits(smaller));
  EXPECT_EQ(smaller.tree.treelet_nodes, 1);
  EXPECT_GE(smaller.tree.stack_entries, 1);
}

TEST(TreeThatFits, LeavesOverridesAlone) {
  ProgramConfig program;
  program.traversal = Traversal::temporary_bin;
  program.n = 3;
  const ProgramConfig given = fitted(program, {2, 4});
  EXPECT_EQ(given.tree.treelet_nodes, 2);
  EXPECT_EQ(given.tree.stack_entries, 4);
  EXPECT_EQ(fitted(program, {{}, 1}).tree.stack_entries, 1);
  program.n = 1;
  program.tree.resident_nodes = 64;  // more than fit with any tree
  EXPECT_EQ(fitted(program).tree.stack_entries, program.tree.stack_entries);
  EXPECT_EQ(fitted(program).tree.treelet_nodes, program.tree.treelet_nodes);
}

/// The user's options enter the estimate by which a traversal is chosen.
TEST(TreeOverrides, ChangeTheEstimate) {
  const ProgramConfig program;
  const path_tracer::TreeShape& tree = program.tree;
  const path_tracer::TreeShape large = testbench::overridden_tree(program, {16});
  EXPECT_EQ(large.treelet_nodes, 16);
  EXPECT_EQ(testbench::overridden_tree(program, {}).treelet_nodes, tree.treelet_nodes);
  EXPECT_GT(testbench::estimate_traversal(1000000, large, kChip).tree,
            testbench::estimate_traversal(1000000, tree, kChip).tree);
}

TEST(TreeThatFits, IsTheGivenOneEvenIfItIsFarTooLarge) {
  ProgramConfig program;
  program.traversal = Traversal::refill;
  program.n = 8;
  EXPECT_EQ(fitted(program, {path_tracer::kMaxTreeletNodes}).tree.treelet_nodes,
            path_tracer::kMaxTreeletNodes);
}

TEST(TreeThatFits, HasWideNodesWhereTrianglesAreMany) {
  constexpr std::size_t kMany = 1000000;
  ProgramConfig program;
  for (const Traversal traversal : {Traversal::temporary_bin, Traversal::refill, Traversal::lock_step}) {
    program.traversal = traversal;
    EXPECT_EQ(fitted(program, {}, 1000).tree.layout.width, 4);
    const ProgramConfig wide = fitted(program, {}, kMany);
    EXPECT_EQ(wide.tree.layout.width, 8);
    EXPECT_EQ(wide.tree.treelet_nodes, 1);
    EXPECT_TRUE(fits(wide));
  }
  program.traversal = Traversal::packets;
  EXPECT_EQ(fitted(program, {}, kMany).tree.layout.width, 4);
}

TEST(TreeThatFits, HasTheFormatThatSuitsTheTraversalOrIsGiven) {
  using path_tracer::NodeFormat;
  ProgramConfig program;
  const auto format = [&](Traversal traversal, const testbench::TreeOverrides& overrides) {
    program.traversal = traversal;
    return fitted(program, overrides, 1000000).tree.layout.format;
  };
  EXPECT_EQ(format(Traversal::refill, {}), NodeFormat::quantised8);
  EXPECT_EQ(format(Traversal::temporary_bin, {}), NodeFormat::quantised8);
  EXPECT_EQ(format(Traversal::lock_step, {}), NodeFormat::fp32);
  EXPECT_EQ(format(Traversal::packets, {}), NodeFormat::fp32);
  EXPECT_EQ(format(Traversal::refill, {{}, {}, 2}), NodeFormat::fp32) << "quantised nodes have four or more";
  EXPECT_EQ(format(Traversal::refill, {{}, {}, {}, {}, NodeFormat::fp64}), NodeFormat::fp64);
}

TEST(TreeThatFits, HasNarrowNodesWhereWideOnesDoNotFit) {
  ProgramConfig program;
  program.traversal = Traversal::temporary_bin;
  program.n = 3;
  program.tree.resident_nodes = 1;
  const ProgramConfig narrow = fitted(program, {{}, {}, {}, {}, path_tracer::NodeFormat::fp32}, 1000000);
  EXPECT_EQ(narrow.tree.layout.width, 4);
  EXPECT_TRUE(fits(narrow));
}

TEST(TreeThatFits, HasTheGivenWidthAndVisits) {
  ProgramConfig program;
  program.traversal = Traversal::refill;
  const ProgramConfig binary = fitted(program, {{}, {}, 2, 5}, 1000000);
  EXPECT_EQ(binary.tree.layout.width, 2);
  EXPECT_EQ(binary.tree.treelet_nodes, 4) << "as many children as other widths";
  EXPECT_EQ(binary.tree.visits, 5);
  EXPECT_EQ(fitted(program, {{}, {}, 8, {}}).tree.layout.width, 8);
}

TEST(ResidentNodes, AreNoMoreThanATreeHas) {
  ProgramConfig program;
  program.traversal = Traversal::refill;
  program.tree.resident_nodes = testbench::kAsManyAsFit;
  testbench::complete_traversal(3, kChip, program);
  EXPECT_LE(program.tree.resident_nodes, 3);
  program.tree.resident_nodes = 2;
  testbench::complete_traversal(1000000, kChip, program);
  EXPECT_EQ(program.tree.resident_nodes, 2) << "as it was asked for";
}

}  // namespace traversal_choice_test
