#include "testbench/statistics/renamed_keys.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "testbench/statistics/counters.hpp"
#include "testbench/system/error.hpp"

namespace renamed_keys_test {

using testbench::all_counters;
using testbench::new_name_of;
using testbench::renamed_keys;

bool is_declared(const std::string& key_or_section) {
  const auto& counters = all_counters();
  return std::any_of(counters.begin(), counters.end(), [&](const testbench::Counter& counter) {
    return counter.key == key_or_section || counter.key.rfind(key_or_section + ".", 0) == 0;
  });
}

TEST(RenamedKeys, OldNamesAreGoneAndNewOnesDeclared) {
  for (const testbench::RenamedKey& renamed : renamed_keys()) {
    EXPECT_FALSE(is_declared(std::string(renamed.old_key))) << renamed.old_key;
    EXPECT_TRUE(is_declared(std::string(renamed.new_key))) << renamed.new_key;
  }
}

TEST(RenamedKeys, KeysBelowARenamedOneAreRenamedWithIt) {
  EXPECT_EQ(new_name_of("chip.host_link.host_dmas"), "chip.host_link.transfers");
  EXPECT_EQ(new_name_of("chip.host_link.host_dmas.x"), "chip.host_link.transfers.x");
  EXPECT_EQ(new_name_of("chip.host_link.host_dmas_x"), "");
  EXPECT_EQ(new_name_of("chip.host_link.transfers"), "");
  EXPECT_EQ(new_name_of("host_link.host_dmas"), "");
  EXPECT_EQ(new_name_of("host.cpu_seconds"), "simulator.cpu_seconds");
  EXPECT_EQ(new_name_of("chip_config.host.bytes_per_second"), "");
  EXPECT_EQ(new_name_of(""), "");
}

TEST(RenamedKeys, AnOldOneIsRefusedWithItsNewName) {
  testbench::require_current_keys("a.json", {{"segments", 1}, {"chip.host_link.transfers", 2}});
  try {
    testbench::require_current_keys("a.json", {{"segments", 1}, {"chip.host_link.host_dmas", 2}});
    FAIL();
  } catch (const testbench::InputError& error) {
    EXPECT_STREQ(error.what(),
                 "a.json: chip.host_link.host_dmas: found the key's old name, allowed is "
                 "chip.host_link.transfers");
  }
}

}  // namespace renamed_keys_test
