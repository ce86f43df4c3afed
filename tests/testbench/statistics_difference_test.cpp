#include "testbench/statistics/statistics_difference.hpp"

#include <gtest/gtest.h>

namespace statistics_difference_test {

using testbench::compare;
using testbench::Comparison;
using testbench::ComparisonRules;
using testbench::FlatStatistics;

const FlatStatistics kRun = {{"scene", "box"},
                             {"segments", 1000},
                             {"chip.ddr.page_hits", 200},
                             {"chip.pio.pes", 0},
                             {"counts.steps", 7},
                             {"simulated_seconds", nullptr},
                             {"simulator.cpu_seconds", 1.5}};

FlatStatistics with(const std::string& key, const nlohmann::ordered_json& value) {
  FlatStatistics run = kRun;
  for (auto& [name, old] : run)
    if (name == key) old = value;
  return run;
}

std::vector<std::string> keys(const Comparison& comparison) {
  std::vector<std::string> keys;
  for (const auto& difference : comparison.differences) keys.push_back(difference.key);
  return keys;
}
using Keys = std::vector<std::string>;

TEST(StatisticsDifference, EqualRunsHaveNone) {
  const Comparison comparison = compare(kRun, kRun, {});
  EXPECT_TRUE(comparison.differences.empty());
  EXPECT_EQ(comparison.keys.size(), kRun.size());
}

TEST(StatisticsDifference, AnyOtherValueIsOne) {
  EXPECT_EQ(keys(compare(kRun, with("segments", 1001), {})), Keys{"segments"});
  EXPECT_EQ(keys(compare(kRun, with("scene", "bax"), {})), Keys{"scene"});
  EXPECT_EQ(keys(compare(kRun, with("simulated_seconds", 0.0), {})), Keys{"simulated_seconds"});
  EXPECT_EQ(keys(compare(kRun, with("chip.pio.pes", "0"), {})), Keys{"chip.pio.pes"});
  EXPECT_TRUE(compare(kRun, with("segments", 1000.0), {}).differences.empty()) << "integer and real";
}

TEST(StatisticsDifference, KeysOfOneRunOnlyAreOnes) {
  FlatStatistics more = kRun;
  more.insert(more.begin() + 2, {"chip.ddr.banks", 4});
  EXPECT_EQ(keys(compare(kRun, more, {})), Keys{"chip.ddr.banks"});
  EXPECT_EQ(keys(compare(more, kRun, {})), Keys{"chip.ddr.banks"});
  EXPECT_EQ(compare(kRun, more, {}).keys.size(), kRun.size() + 1);
  EXPECT_FALSE(compare(kRun, more, {}).differences[0].relative());
  EXPECT_NE(difference_text(compare(kRun, more, {}).differences).find("missing"), std::string::npos);
}

TEST(StatisticsDifference, RelativeIsOfTheLargerOne) {
  EXPECT_DOUBLE_EQ(*compare(kRun, with("segments", 1250), {}).differences[0].relative(), 0.2);
  EXPECT_DOUBLE_EQ(*compare(kRun, with("segments", 500), {}).differences[0].relative(), -0.5);
  EXPECT_DOUBLE_EQ(*compare(kRun, with("chip.pio.pes", 3), {}).differences[0].relative(), 1);
}

TEST(StatisticsDifference, TolerancesAreByGlobAndTheLastCounts) {
  const FlatStatistics other = with("chip.ddr.page_hits", 202);
  const auto differs = [&](const ComparisonRules& rules) {
    return !compare(kRun, other, rules).differences.empty();
  };
  EXPECT_TRUE(differs({}));
  EXPECT_FALSE(differs({{{"chip.*", 0.01}}, {}}));
  EXPECT_FALSE(differs({{{"*hits", 0.01}}, {}}));
  EXPECT_TRUE(differs({{{"chip.ddr", 0.01}}, {}})) << "a glob is of the whole key";
  EXPECT_TRUE(differs({{{"chip.*", 0.0098}}, {}}));
  EXPECT_TRUE(differs({{{"chip.*", 0.01}, {"chip.ddr.*", 0}}, {}}));
  EXPECT_FALSE(differs({{{"chip.ddr.*", 0}, {"chip.*", 0.01}}, {}}));
  EXPECT_TRUE(compare(kRun, with("scene", "bax"), {{{"*", 1000}}, {}}).differences.size() == 1)
      << "texts have no tolerance";
}

TEST(StatisticsDifference, IgnoredKeysAreNotCompared) {
  const FlatStatistics other = with("simulator.cpu_seconds", 99);
  EXPECT_EQ(keys(compare(kRun, other, {})), Keys{"simulator.cpu_seconds"});
  EXPECT_TRUE(compare(kRun, other, {{}, {"simulator.*"}}).differences.empty());
  EXPECT_EQ(compare(kRun, other, {{}, {"simulator.*", "s*"}}).keys.size(), kRun.size() - 4);
}

TEST(StatisticsDifference, TextShowsGroupValuesShareAndUnit) {
  FlatStatistics other = with("chip.ddr.page_hits", 250);
  other[4].second = 8;
  EXPECT_EQ(difference_text(compare(kRun, other, {}).differences),
            "chip.ddr\n"
            "  page_hits                       200                       250         +20 %  count\n"
            "counts\n"
            "  steps                             7                         8       +12.5 %  count\n");
  EXPECT_EQ(testbench::difference_text({}), "");
}

}  // namespace statistics_difference_test
