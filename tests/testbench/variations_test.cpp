// The chips that a sensitivity study tries: one parameter changed, within its range and on its grid.

#include "testbench/sensitivity/variations.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "model/config/chip_parameters.hpp"
#include "model/config/chip_presets.hpp"

namespace variations_test {

using testbench::Variation;
using testbench::VariationKind;
using testbench::Variations;
using testbench::variations_of;
using Values = std::vector<std::string>;

Values values(const Variations& variations, const std::string& key) {
  Values found;
  for (const Variation& variation : variations.list)
    if (variation.key == key) found.push_back(variation.value);
  return found;
}

TEST(VariationsOfAChip, NumbersChangeByTheShareOnTheirGrid) {
  const Variations all = variations_of(model::preset("csx600"), 0.1, {});
  EXPECT_EQ(values(all, "chip.clock_hz"), (Values{"189000000", "231000000"}));
  EXPECT_EQ(values(all, "pio.setup_cycles"), (Values{"135", "165"}));
  EXPECT_EQ(values(all, "chip.pes"), (Values{"88", "104"}));
  EXPECT_EQ(values(all, "pio.misalignment_cycles"), (Values{"7", "9"}));
  EXPECT_EQ(values(all, "control.data_cache_bytes"), (Values{"2048", "8192"}));
  EXPECT_EQ(values(all, "poly.cycles.fp64_add"), (Values{"3.6", "4.4"}));
}

TEST(VariationsOfAChip, ChoicesTakeEveryOtherValue) {
  const Variations all = variations_of(model::preset("csx600"), 0.1, {});
  EXPECT_EQ(values(all, "pio.arbitration"), (Values{"strict_fifo", "queue_per_direction"}));
  EXPECT_EQ(values(all, "pio.consolidate_equal_addresses"), (Values{"true"}));
}

TEST(VariationsOfAChip, NoCyclesBecomeOneAndOtherZerosAreLeftOut) {
  const Variations all = variations_of(model::preset("csx600"), 0.1, {});
  EXPECT_EQ(values(all, "control.thread_switch_cycles"), (Values{"1"}));
  EXPECT_EQ(values(all, "clear_connect.ddr_port_bytes_per_cycle"), (Values{}));
  EXPECT_TRUE(std::any_of(all.left_out.begin(), all.left_out.end(), [](const testbench::LeftOut& left) {
    return left.key == "clear_connect.ddr_port_bytes_per_cycle";
  }));
}

TEST(VariationsOfAChip, EachIsTheChipWithThatParameterAlone) {
  const model::ChipConfig chip = model::preset("paper");
  const Variations all = variations_of(chip, 0.25, {});
  EXPECT_GT(all.list.size(), 150u);
  for (const Variation& variation : all.list)
    for (const model::ParameterInfo& parameter : model::parameter_table()) {
      const bool is_same = parameter.read(variation.chip) == parameter.read(chip);
      EXPECT_EQ(is_same, parameter.key != variation.key) << variation.key << " " << parameter.key;
    }
}

TEST(VariationsOfAChip, EveryParameterIsVariedOrSaysWhyNot) {
  const Variations all = variations_of(model::preset("csx600"), 0.1, {});
  std::map<std::string, int> seen;
  for (const Variation& variation : all.list) ++seen[variation.key];
  for (const testbench::LeftOut& left : all.left_out) {
    EXPECT_FALSE(left.reason.empty()) << left.key;
    ++seen[left.key];
  }
  for (const model::ParameterInfo& parameter : model::parameter_table())
    EXPECT_GE(seen[parameter.key], 1) << parameter.key;
}

TEST(VariationsOfAChip, WhatTheFirmwareSeesIsMarked) {
  for (const Variation& variation : variations_of(model::preset("csx600"), 0.1, {}).list)
    EXPECT_EQ(variation.changes_requests,
              model::find_parameter(variation.key)->effect == model::Effect::stream)
        << variation.key;
}

TEST(VariationsOfAChip, OnlyTheKeysThatBeginSo) {
  for (const Variation& variation : variations_of(model::preset("csx600"), 0.1, {"pio.", "ddr.b"}).list)
    EXPECT_TRUE(variation.key.rfind("pio.", 0) == 0 || variation.key.rfind("ddr.b", 0) == 0) << variation.key;
  EXPECT_TRUE(variations_of(model::preset("csx600"), 0.1, {"none"}).list.empty());
}

}  // namespace variations_test
