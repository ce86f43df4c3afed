#include "firmware/cn/language/shortcut.hpp"

#include "firmware/cn/language/control.hpp"
#include "tests/support/strip_fixture.hpp"

namespace shortcut_test {

using cn::InstructionClass;
using test_support::counts;

/// Three strips.
class Shortcut : public test_support::StripFixture {};

TEST_F(Shortcut, WithoutChargingReturnsTheResultAndChargesNone) {
  int sum = 0;
  const auto issued = issued_by([&] {
    cn::issue(InstructionClass::move, 2);
    sum += cn::without_charging([] {
      cn::issue(InstructionClass::fp64_div, 7);
      return 5;
    });
    cn::without_charging([] { cn::issue(InstructionClass::mono); });
    cn::issue(InstructionClass::move);
  });
  EXPECT_EQ(sum, 3 * 5);
  EXPECT_EQ(issued, counts({{InstructionClass::move, 3}}));
}

TEST_F(Shortcut, ChargeTimesRunsOnceAndChargesOften) {
  int runs = 0;
  const auto issued = issued_by([&] {
    cn::issue(InstructionClass::fp64_add);
    cn::charge_times(38, [&] {
      ++runs;
      cn::issue(InstructionClass::fp64_add, 2);
      cn::issue(InstructionClass::move);
    });
  });
  EXPECT_EQ(runs, 3) << "once for each strip";
  EXPECT_EQ(issued, counts({{InstructionClass::fp64_add, 1 + 38 * 2}, {InstructionClass::move, 38}}));
}

TEST_F(Shortcut, OnlyTheFirstStripOfANodeMustCharge) {
  std::vector<bool> root;
  std::vector<bool> branch;
  run([&] {
    root.push_back(cn::is_charged());
    cn::poly_if_any(cn::pe_num() >= cn::poly<std::int32_t>(8), [&] { branch.push_back(cn::is_charged()); });
  });
  EXPECT_EQ(root, (std::vector<bool>{false, true, true}));
  EXPECT_EQ(branch, (std::vector<bool>{false, true})) << "the first strip does not come there";
}

/// What the shortcut issues differs from strip to strip; the charge does not show it.
TEST_F(Shortcut, FoundAnotherWayChargesTheCnCodeAndReturnsTheShortcut) {
  std::vector<int> found;
  const auto issued = issued_by([&] {
    found.push_back(cn::found_another_way([] { cn::issue(InstructionClass::fp64_mul, 9); },
                                          [] {
                                            const int first_pe = cn::strip.first_pe;
                                            cn::issue(InstructionClass::fp64_mul, unsigned(first_pe));
                                            return first_pe;
                                          }));
  });
  EXPECT_EQ(found, (std::vector<int>{0, 8, 16}));
  EXPECT_EQ(issued, counts({{InstructionClass::fp64_mul, 9}}));
}

}  // namespace shortcut_test
