#include "testbench/statistics/renamed_keys.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "firmware/path_tracer/kernels/kernels.hpp"
#include "testbench/statistics/counters.hpp"
#include "testbench/system/error.hpp"

namespace renamed_keys_test {

using testbench::all_counters;
using testbench::new_name_of;
using testbench::renamed_keys;

/// Whether the path tracer has a kernel of that name.
bool is_kernel(const std::string& name) {
  const path_tracer::Kernels& kernels = path_tracer::kernels(cn::narrowest_level());
  const char* const names[] = {
      kernels.intersect.name,      kernels.scatter.name, kernels.illuminate.name,     kernels.append.name,
      kernels.continue_paths.name, kernels.list.name,    kernels.finished_place.name, kernels.fold.name};
  return std::find(std::begin(names), std::end(names), name) != std::end(names);
}

bool is_declared(const std::string& key_or_section) {
  const std::string of_kernels = "chip.pe_array.kernels.";
  if (key_or_section.rfind(of_kernels, 0) == 0) return is_kernel(key_or_section.substr(of_kernels.size()));
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
  EXPECT_EQ(new_name_of("chip.pe_array.kernels.replace.runs"), "chip.pe_array.kernels.continue_paths.runs");
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
