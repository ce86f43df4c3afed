#include "firmware/cn/language/control.hpp"

#include <algorithm>

#include "tests/support/lock_step.hpp"

namespace control_test {

using cn::InstructionClass;
using cn::IssueCounts;
using cn::IssueTree;
using cn::LaneMask;
using cn::mask;
using cn::poly;
using test_support::counts;
using test_support::load;
using test_support::PerPe;
using test_support::store;

constexpr int kPes = 24;

class CnControl : public test_support::StripFixture {
 protected:
  CnControl() : StripFixture(kPes) {}

  /// `ran[pe]` counts, for the test, how often a PE was enabled there.
  static void tick(PerPe<int>& ran) {
    for (int i = 0; i < cn::kStripLanes; ++i)
      if (cn::MaskLanes(cn::strip.enabled)[i] != 0) ++ran[std::size_t(cn::strip.first_pe + i)];
  }
  /// An instruction that nothing else here issues.
  static void work() { cn::issue(InstructionClass::fp64_exp); }
  static std::uint64_t worked(const IssueTree& tree) { return tree.total()[InstructionClass::fp64_exp]; }

  template <class Holds>
  static LaneMask pes_where(Holds holds) {
    LaneMask pes;
    for (int pe = 0; pe < kPes; ++pe) pes.set(pe, holds(pe));
    return pes;
  }
  template <class Holds>
  void expect_ran(const PerPe<int>& ran, Holds times) {
    for (int pe = 0; pe < kPes; ++pe) EXPECT_EQ(ran[std::size_t(pe)], int(times(pe))) << "PE " << pe;
  }
};

TEST_F(CnControl, BothBranchesIssueAndElseIsTheComplementOfThoseEnabled) {
  PerPe<int> then = per_pe<int>();
  PerPe<int> otherwise = per_pe<int>();
  PerPe<int> after = per_pe<int>();
  const LaneMask enabled = pes_where([](int pe) { return pe % 3 != 0; });
  run(enabled, [&] {
    cn::poly_if(
        cn::pe_num() < 10, [&] { work(), tick(then); }, [&] { work(), work(), tick(otherwise); });
    tick(after);
  });
  expect_ran(then, [](int pe) { return pe % 3 != 0 && pe < 10; });
  expect_ran(otherwise, [](int pe) { return pe % 3 != 0 && pe >= 10; });
  expect_ran(after, [](int pe) { return pe % 3 != 0; });
  EXPECT_EQ(issue_tree.total(), counts({{InstructionClass::fp64_exp, 3},
                                        {InstructionClass::enable, 3},  // push, invert, pop
                                        {InstructionClass::sram, 1},
                                        {InstructionClass::int32_alu, 1}}));
}

TEST_F(CnControl, ABranchThatNoPeTakesIsIssuedAllTheSame) {
  EXPECT_EQ(issued_by([&] { cn::poly_if(cn::pe_num() < 0, [] { work(); }); }),
            counts({{InstructionClass::fp64_exp, 1},
                    {InstructionClass::enable, 2},
                    {InstructionClass::sram, 1},
                    {InstructionClass::int32_alu, 1}}));
}

TEST_F(CnControl, NestedConditionsNarrow) {
  PerPe<int> inner = per_pe<int>();
  PerPe<int> inner_else = per_pe<int>();
  PerPe<int> outer_else = per_pe<int>();
  run([&] {
    const poly<std::int32_t> pe = cn::pe_num();
    cn::poly_if(
        pe < 16, [&] { cn::poly_if((pe & 1) == 0, [&] { tick(inner); }, [&] { tick(inner_else); }); },
        [&] { tick(outer_else); });
  });
  expect_ran(inner, [](int pe) { return pe < 16 && pe % 2 == 0; });
  expect_ran(inner_else, [](int pe) { return pe < 16 && pe % 2 == 1; });
  expect_ran(outer_else, [](int pe) { return pe >= 16; });
}

TEST_F(CnControl, DisabledPesKeepTheirValues) {
  PerPe<double> value = per_pe(1.5);
  run(pes_where([](int pe) { return pe != 5; }), [&] {
    poly<double> x = load(value);
    cn::poly_if(
        cn::pe_num() < 12, [&] { x = 2.5; }, [&] { x += 1.0; });
    store(value, x);
  });
  for (int pe = 0; pe < kPes; ++pe) EXPECT_EQ(value[std::size_t(pe)], pe == 5 ? 1.5 : 2.5) << pe;
}

TEST_F(CnControl, WhileRunsEachPeAsOftenAsItWantsAndIssuesTheMost) {
  PerPe<int> ran = per_pe<int>();
  PerPe<int> after = per_pe<int>();
  // The longest loop is in the middle strip, so a later strip adds nothing and an earlier one leaves sooner.
  const auto passes = [](int pe) { return pe == 12 ? 5 : pe % 3; };
  PerPe<std::int32_t> wanted = per_pe<std::int32_t>();
  for (int pe = 0; pe < kPes; ++pe) wanted[std::size_t(pe)] = passes(pe);
  run([&] {
    poly<std::int32_t> left = load(wanted);
    cn::poly_while([&] { return left > 0; },
                   [&] {
                     left.assign_all_lanes(left - 1);
                     work(), tick(ran);
                   });
    tick(after);
  });
  expect_ran(ran, passes);
  expect_ran(after, [](int) { return 1; });
  EXPECT_EQ(issue_tree.total(), counts({{InstructionClass::fp64_exp, 5},
                                        {InstructionClass::int32_alu, 5 + 6},
                                        {InstructionClass::reduce, 6},
                                        {InstructionClass::enable, 2}}));
}

TEST_F(CnControl, APeThatFailedTheConditionStaysOutOfTheLoop) {
  PerPe<int> ran = per_pe<int>();
  run([&] {
    int pass = 0;  // PE 0 would hold again in the third pass
    cn::poly_while(
        [&] {
          ++pass;
          return pass == 3 ? cn::pe_num() < 2 : cn::pe_num() == (pass < 4 ? 1 : -1);
        },
        [&] { tick(ran); });
  });
  expect_ran(ran, [](int pe) { return pe == 1 ? 3 : 0; });
}

TEST_F(CnControl, WhileThatNoPeEntersAsksOnce) {
  const auto nothing = [] { work(); };
  const auto asked = counts({{InstructionClass::enable, 2},
                             {InstructionClass::reduce, 1},
                             {InstructionClass::sram, 1},
                             {InstructionClass::int32_alu, 1}});
  EXPECT_EQ(issued_by([&] { cn::poly_while([] { return cn::pe_num() < 0; }, nothing); }), asked);
  IssueCounts disabled = asked;  // disabled PEs cannot either; the control unit must ask to know
  disabled += counts({{InstructionClass::enable, 2}});
  EXPECT_EQ(issued_by([&] {
              cn::poly_if(mask(cn::MaskLanes{}),
                          [&] { cn::poly_while([] { return cn::pe_num() < 100; }, nothing); });
            }),
            disabled);
}

TEST_F(CnControl, IfAnyIssuesItsBodyOnceAPeWantsIt) {
  for (const int wanting : {-1, 0, 11, 23}) {
    PerPe<int> ran = per_pe<int>();
    run([&] { cn::poly_if_any(cn::pe_num() == wanting, [&] { work(), tick(ran); }); });
    expect_ran(ran, [&](int pe) { return pe == wanting; });
    EXPECT_EQ(issue_tree.total(), counts({{InstructionClass::fp64_exp, wanting < 0 ? 0u : 1u},
                                          {InstructionClass::reduce, 1},
                                          {InstructionClass::enable, 2},
                                          {InstructionClass::sram, 1},
                                          {InstructionClass::int32_alu, 1}}));
  }
}

TEST_F(CnControl, IfAnyAsksOnlyEnabledPes) {
  run(LaneMask::first(8), [&] { cn::poly_if_any(cn::pe_num() >= 8, [] { work(); }); });
  EXPECT_EQ(worked(issue_tree), 0u);
}

TEST_F(CnControl, RegionsInALoopOfTheControlUnitAreNodesOfTheirOwn) {
  run([&] {
    for (int i = 0; i < 3; ++i) cn::poly_if_any(cn::pe_num() < 8 * i, [] { work(); });
  });
  EXPECT_EQ(worked(issue_tree), 2u);
  const auto& regions = issue_tree.root().regions;
  ASSERT_EQ(regions.size(), 3u);
  EXPECT_TRUE(regions[0].empty());
  EXPECT_EQ(regions[1][0]->enabled_lanes, 8u);
  EXPECT_EQ(regions[2][0]->enabled_lanes, 16u);
}

TEST_F(CnControl, NodesCountTheLanesThatEnterThem) {
  run(pes_where([](int pe) { return pe != 0 && pe < 16; }), [&] {
    poly<std::int32_t> left = cn::pe_num() >> 3;  // 0 in the first strip, 1 in the second
    cn::poly_while([&] { return left > 0; }, [&] { left.assign_all_lanes(left - 1); });
  });
  const IssueTree::Node& root = issue_tree.root();
  EXPECT_EQ(root.enabled_lanes, 15u);
  const IssueTree::Region& passes = root.regions.at(0);
  ASSERT_EQ(passes.size(), 2u);
  EXPECT_EQ(passes[0]->enabled_lanes, 15u);
  EXPECT_EQ(passes[0]->regions.at(0).at(0)->enabled_lanes, 8u);
  EXPECT_EQ(passes[1]->enabled_lanes, 8u);
  EXPECT_FALSE(passes[1]->regions.size() > 0 && passes[1]->regions[0][0]->reached);
}

TEST_F(CnControl, AKernelWithoutPesRunsNothing) {
  run([] { work(); });
  run(LaneMask{}, [] { ADD_FAILURE() << "ran"; });
  EXPECT_EQ(issue_tree.total(), IssueCounts{});
  EXPECT_EQ(issue_tree.root().enabled_lanes, 0u);
}

TEST_F(CnControl, KeepsConditionsOfEnabledPesAndRecallsThem) {
  LaneMask kept;
  LaneMask kept_inside;
  PerPe<char> recalled = per_pe<char>();
  const LaneMask enabled = pes_where([](int pe) { return pe % 2 == 0; });
  run(enabled, [&] {
    cn::keep(cn::pe_num() < 10, kept);
    cn::poly_if(cn::pe_num() >= 4, [&] { cn::keep(cn::pe_num() < 10, kept_inside); });
  });
  for (int pe = 0; pe < kPes; ++pe) {
    EXPECT_EQ(kept[pe], pe % 2 == 0 && pe < 10) << pe;
    EXPECT_EQ(kept_inside[pe], pe % 2 == 0 && pe < 10 && pe >= 4) << pe;
  }
  EXPECT_EQ(issued_by([&] { store(recalled, cn::recall(kept)); }), counts({{InstructionClass::sram, 1}}));
  for (int pe = 0; pe < kPes; ++pe) EXPECT_EQ(bool(recalled[std::size_t(pe)]), kept[pe]) << pe;
  EXPECT_EQ(issued_by([&] { cn::keep(mask(cn::MaskLanes{}), kept); }), counts({{InstructionClass::sram, 1}}));
  EXPECT_FALSE(kept.any());
}

TEST_F(CnControl, RandomProgramsEqualAChipInLockStep) {
  int loops_entered = 0;
  for (unsigned seed = 0; seed < 1500; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const test_support::Block program = test_support::ProgramGenerator(seed).block(4, 0);
    std::mt19937 random(seed);
    std::vector<PerPe<std::int32_t>> variables(test_support::kVariables + test_support::kMaxLoopDepth,
                                               per_pe<std::int32_t>());
    for (auto& variable : variables)
      for (auto& value : variable) value = static_cast<std::int32_t>(random());
    const unsigned density = random() % 4;
    const LaneMask enabled = pes_where([&](int pe) { return pe == 17 || random() % 4 <= density; });

    const test_support::Outcome expected = test_support::LockStepRun(variables, enabled).run(program);
    run(enabled, [&] { test_support::CnRun(variables).run(program); });
    for (std::size_t v = 0; v < variables.size(); ++v) {
      for (int pe = 0; pe < kPes; ++pe) {
        if (!enabled[pe]) continue;
        ASSERT_EQ(variables[v][std::size_t(pe)], expected.variables[v][std::size_t(pe)])
            << "variable " << v << " PE " << pe;
      }
    }
    ASSERT_EQ(issue_tree.total(), expected.issued);
    std::uint64_t lane_instructions = 0;
    issue_tree.for_each_node([&](const IssueTree::Node& node) {
      for (const std::uint64_t times : node.counts.by_class) lane_instructions += times * node.enabled_lanes;
    });
    ASSERT_EQ(lane_instructions, expected.lane_instructions);
    loops_entered += expected.issued[InstructionClass::reduce] > 10;
  }
  EXPECT_GT(loops_entered, 100);
}

}  // namespace control_test
