#include "model/pe_array/pe_array.hpp"

#include "tests/support/systemc_fixture.hpp"
#include "tests/support/test_chip.hpp"

namespace pe_array_test {

using cn::InstructionClass;
using cn::IssueTree;
using test_support::test_chip;

class PeArray : public test_support::SystemCFixture {};

model::ChipConfig priced_chip() {
  model::ChipConfig config = test_chip();
  config.poly.cycles[std::size_t(InstructionClass::fp64_add)] = 4;
  config.poly.cycles[std::size_t(InstructionClass::sram)] = 2;
  config.poly.cycles[std::size_t(InstructionClass::mono)] = 3;
  return config;
}

/// Eight PEs enter a loop, five stay for its second pass; a region inside it is reached by two.
class Loop {
 public:
  Loop() {
    reach(root(), 8).counts[InstructionClass::fp64_add] = 10;                   // 40 cycles
    reach(tree_.node(root(), 0, 0), 8).counts[InstructionClass::fp64_add] = 5;  // 20 cycles
    IssueTree::Node& second = reach(tree_.node(root(), 0, 1), 5);
    second.counts[InstructionClass::sram] = 5;  // 10 cycles
    // No PE reached this node: its instructions do not count.
    tree_.node(second, 0, 0).counts[InstructionClass::fp64_add] = 1000;
    reach(tree_.node(second, 1, 0), 2).counts[InstructionClass::sram] = 15;  // 30 cycles
  }
  operator const IssueTree&() const { return tree_; }
  IssueTree::Node& root() { return tree_.root(); }

 private:
  static IssueTree::Node& reach(IssueTree::Node& node, int lanes) {
    node.reached = true;
    node.enabled_lanes = std::uint64_t(lanes);
    return node;
  }

  IssueTree tree_;
};

TEST_F(PeArray, CostAddsUpTheNodesThatWereReached) {
  const model::ChipConfig config = priced_chip();
  model::PeArray array("pe_array", config);
  const model::PeArray::Cost cost = array.retire("loop", Loop());
  EXPECT_EQ(cost.cycles, 100u);
  EXPECT_EQ(cost.sram_cycles, 40u);
}

TEST_F(PeArray, CodeQualityScalesAllInstructions) {
  model::ChipConfig config = priced_chip();
  config.poly.code_quality_factor = 1.25;
  model::PeArray array("pe_array", config);
  const model::PeArray::Cost cost = array.retire("loop", Loop());
  EXPECT_EQ(cost.cycles, 125u);
  EXPECT_EQ(cost.sram_cycles, 50u);
  Loop with_mono;
  with_mono.root().counts[InstructionClass::mono] = 50;     // 150 cycles, the longer stream
  EXPECT_EQ(array.retire("loop", with_mono).cycles, 188u);  // 187.5
  with_mono.root().counts[InstructionClass::mono] = 33;     // 99, hidden
  EXPECT_EQ(array.retire("loop", with_mono).cycles, 125u);
}

/// 10 cycles of vector arithmetic, `load_words` of 2 cycles, and 5 cycles that overlap with nothing.
class VectorCode {
 public:
  explicit VectorCode(std::uint64_t load_words) {
    IssueTree::Node& root = tree_.root();
    root.reached = true;
    root.enabled_lanes = 8;
    root.counts[InstructionClass::fp64_add_vector4] = 2;
    root.counts[InstructionClass::fp32_multiply_add_vector4] = 8;
    root.counts[InstructionClass::move] = 5;
    root.counts[InstructionClass::sram_vector_load] = load_words;
  }
  operator const IssueTree&() const { return tree_; }

 private:
  IssueTree tree_;
};

TEST_F(PeArray, VectorLoadsGoOnBesideVectorArithmeticOnly) {
  model::ChipConfig config = priced_chip();
  config.poly.cycles[std::size_t(InstructionClass::sram_vector_load)] = 2;
  config.poly.vector_loads_overlap = true;
  model::PeArray array("pe_array", config);
  EXPECT_EQ(array.retire("few", VectorCode(3)).cycles, 15u);
  EXPECT_EQ(array.retire("few", VectorCode(3)).sram_cycles, 6u);
  EXPECT_EQ(array.retire("many", VectorCode(7)).cycles, 19u);  // 14 of loads, 5 of moves
  EXPECT_EQ(array.retire("many", VectorCode(7)).sram_cycles, 14u);
}

TEST_F(PeArray, VectorLoadsAddUpOnAChipThatDoesNotOverlapThem) {
  model::ChipConfig config = priced_chip();
  config.poly.cycles[std::size_t(InstructionClass::sram_vector_load)] = 2;
  config.poly.vector_loads_overlap = false;
  model::PeArray array("pe_array", config);
  EXPECT_EQ(array.retire("few", VectorCode(3)).cycles, 21u);
  EXPECT_EQ(array.retire("many", VectorCode(7)).cycles, 29u);
}

TEST_F(PeArray, CostIsRoundedOnceAKernel) {
  model::ChipConfig config = priced_chip();
  config.poly.cycles[std::size_t(InstructionClass::fp64_add)] = 0.4;
  model::PeArray array("pe_array", config);
  IssueTree tree;
  tree.root().reached = true;
  tree.root().enabled_lanes = 8;
  tree.root().counts[InstructionClass::fp64_add] = 6;
  EXPECT_EQ(array.retire("kernel", tree).cycles, 2u);  // 2.4
  tree.root().counts[InstructionClass::fp64_add] = 7;
  EXPECT_EQ(array.retire("kernel", tree).cycles, 3u);  // 2.8
}

TEST_F(PeArray, EfficiencyWeighsPesByTheCyclesTheyWereEnabledIn) {
  const model::ChipConfig config = priced_chip();
  model::PeArray array("pe_array", config);
  array.retire("loop", Loop());
  // (60 cycles x 8 + 10 x 5 + 30 x 2) / (100 x 8)
  EXPECT_DOUBLE_EQ(array.kernels()[0].simd_efficiency(array.num_pes()), 590.0 / 800.0);
  EXPECT_DOUBLE_EQ(array.total().simd_efficiency(8), 590.0 / 800.0);
}

TEST_F(PeArray, EfficiencyIsNotChangedByCodeQualityOrMonoInstructions) {
  model::ChipConfig config = priced_chip();
  config.poly.code_quality_factor = 3;
  model::PeArray array("pe_array", config);
  Loop with_mono;
  with_mono.root().counts[InstructionClass::mono] = 100000;
  array.retire("loop", with_mono);
  EXPECT_DOUBLE_EQ(array.total().simd_efficiency(8), 590.0 / 800.0);
}

TEST_F(PeArray, EfficiencyOfNothingIsOne) {
  EXPECT_DOUBLE_EQ(model::KernelStatistics{}.simd_efficiency(8), 1.0);
}

/// The block that the last run issued at a place is only a guess of the one that is issued there now.
TEST_F(PeArray, RunsOfAKernelMayDiffer) {
  const model::ChipConfig config = priced_chip();
  model::PeArray array("pe_array", config);
  cn::IssueCounts issued;
  cn::IssueCounts executed;
  for (const unsigned adds : {3u, 5u, 3u, 3u, 7u, 5u}) {
    IssueTree tree;
    tree.root().reached = true;
    tree.root().enabled_lanes = adds;
    tree.root().counts[InstructionClass::fp64_add] = adds;
    for (unsigned i = 0; i < adds % 4; ++i) {
      IssueTree::Node& node = tree.node(tree.root(), 0, i);
      node.reached = true;
      node.enabled_lanes = 2;
      node.counts[InstructionClass::sram] = adds + i;
      executed[InstructionClass::sram] += 2 * (adds + i);
    }
    issued += tree.total();
    executed[InstructionClass::fp64_add] += adds * adds;
    static constexpr const char* kName = "changes";
    model::PeArray fresh(sc_core::sc_gen_unique_name("fresh"), config);
    EXPECT_EQ(array.retire(kName, tree).cycles, fresh.retire(kName, tree).cycles);
  }
  EXPECT_EQ(array.kernels()[0].issued, issued);
  EXPECT_EQ(array.kernels()[0].executed, executed);
}

TEST_F(PeArray, CountsByKernelInTheOrderOfTheirFirstRun) {
  const model::ChipConfig config = priced_chip();
  model::PeArray array("pe_array", config);
  static constexpr const char* kLoop = "loop";
  static constexpr const char* kShort = "short";
  IssueTree tree;
  tree.root().reached = true;
  tree.root().enabled_lanes = 4;
  tree.root().counts[InstructionClass::sram] = 3;
  array.retire(kLoop, Loop());
  array.retire(kShort, tree);
  array.retire(kLoop, Loop());
  const std::vector<model::KernelStatistics> kernels = array.kernels();
  ASSERT_EQ(kernels.size(), 2u);
  const model::KernelStatistics& of_loop = kernels[0];
  EXPECT_EQ(of_loop.name, "loop");
  EXPECT_EQ(of_loop.runs, 2u);
  EXPECT_EQ(of_loop.cycles, 200u);
  EXPECT_EQ(of_loop.issued[InstructionClass::fp64_add], 30u);
  EXPECT_EQ(of_loop.issued[InstructionClass::sram], 40u);
  EXPECT_EQ(kernels[1].name, "short");
  EXPECT_EQ(kernels[1].cycles, 6u);
  EXPECT_DOUBLE_EQ(kernels[1].simd_efficiency(8), 0.5);
  const model::KernelStatistics total = array.total();
  EXPECT_EQ(total.runs, 3u);
  EXPECT_EQ(total.cycles, 206u);
  EXPECT_EQ(total.issued[InstructionClass::sram], 43u);
  EXPECT_DOUBLE_EQ(total.simd_efficiency(8), (2 * 590.0 + 24.0) / (2 * 800.0 + 48.0));
}

}  // namespace pe_array_test
