// The search unit as users ask for it: chips with and without one, its waves, its counters, and sweeps.

#include <nlohmann/json.hpp>

#include "tests/support/command_line.hpp"

namespace ray_unit_command_test {

using Json = nlohmann::json;
using test_support::CommandResult;
using Words = std::vector<std::string>;

const std::string kCornellBox = std::string(CSX600_SCENES_DIR) + "/cornell_box";

class RayUnitCommand : public test_support::CommandLineFixture {
 protected:
  Json statistics(const Words& more) {
    Words arguments = {"render", kCornellBox, "--size", "8x6", "--samples", "2", "--stats", "s.json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const CommandResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.error;
    return Json::parse(read("s.json"));
  }
  void expect_error(const Words& more, const Words& parts) {
    Words arguments = {"render", kCornellBox, "--size", "8x6", "--samples", "2", "--traversal", "ray_unit"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const CommandResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.out, "");
    ASSERT_EQ(result.error_lines().size(), 1u) << result.error;
    for (const std::string& part : parts)
      EXPECT_NE(result.error.find(part), std::string::npos) << part << " in " << result.error;
  }
};

TEST_F(RayUnitCommand, ChipsThatCannotAreRefusedInOneLine) {
  expect_error({}, {"traversal: found ray_unit", "search_unit.units is 0"});
  expect_error({"--set", "search_unit.units=1", "--bin-blocks", "64"},
               {"bin_blocks: found 64", "at most 13", "search_unit.buffer_bytes (131072)"});
  expect_error({"--set", "search_unit.units=1", "--set", "search_unit.cache_ways=3"},
               {"search_unit.cache_bytes: found '16384'", "search_unit.cache_line_bytes (64)"});
  expect_error({"--set", "search_unit.units=1", "--set", "search_unit.first_address=1099511627776"},
               {"search_unit.first_address", "on_chip_sram.first_address"});
  expect_error({"--set", "search_unit.units=1", "--set", "chip.arrays=2"},
               {"search_unit.units: found '1'", "chip.arrays (2)"});
  expect_error({"--set", "search_unit.width=0"}, {"search_unit.width: found '0'", "1 to 8"});
}

/// Its counters and its area are in the statistics of a chip that has one, and of no other.
TEST_F(RayUnitCommand, StatisticsAreThoseOfTheChip) {
  const Json without = statistics({});
  EXPECT_TRUE(without["chip"]["search_unit"]["counts"].empty());
  EXPECT_FALSE(without["chip"]["area"]["mm2_by_part"].contains("search_unit_tests"));
  const Json with = statistics({"--set", "search_unit.units=1", "--traversal", "ray_unit"});
  EXPECT_EQ(with["image_sha256"], without["image_sha256"]);
  EXPECT_EQ(with["chip"]["search_unit"]["counts"]["queries"],
            with["counts"]["segments"].get<int>() + with["counts"]["shadow_rays"].get<int>());
  EXPECT_GT(with["chip"]["energy"]["joules_by_cause"]["search_unit"], 0.0);
  EXPECT_GT(with["chip"]["area"]["mm2"], without["chip"]["area"]["mm2"]);
  const Json idle = statistics({"--set", "search_unit.units=1"});
  EXPECT_EQ(idle["simulated_cycles"], without["simulated_cycles"])
      << "a unit that nobody uses costs no cycle";
}

TEST_F(RayUnitCommand, WavesShowTheQueriesInFlight) {
  statistics({"--set", "search_unit.units=1", "--traversal", "ray_unit", "--waves", "a.vcd"});
  const std::string waves = read("a.vcd");
  EXPECT_NE(waves.find("$scope module search_unit $end"), std::string::npos);
  statistics({"--waves", "b.vcd"});
  EXPECT_EQ(read("b.vcd").find("search_unit"), std::string::npos);
}

/// A recording knows no steps of the unit, so each point is run.
TEST_F(RayUnitCommand, SweepsRunItsPointsInFull) {
  write("sweep.toml", "scene = \"" + kCornellBox +
                          "\"\nsize = \"8x6\"\nsamples = 2\nfirmware.traversal = \"ray_unit\"\n"
                          "search_unit.units = 1\n[[axis]]\nsearch_unit.node_cycles = [16, 4000]\n"
                          "[[axis]]\npio.setup_cycles = [100, 200]\n");
  const CommandResult result = run({"sweep", "sweep.toml"});
  ASSERT_EQ(result.exit_code, 0) << result.error;
  const Json sweep = Json::parse(read("sweep.sweep/sweep.json"));
  std::vector<double> cycles;
  for (const Json& point : sweep["points"]) cycles.push_back(point["results"]["simulated_cycles"]);
  ASSERT_EQ(cycles.size(), 4u);
  EXPECT_LT(cycles[0], cycles[1]);
  EXPECT_LT(cycles[1], cycles[2]) << "the array waits for a slow unit";
  EXPECT_NE((result.out + result.error).find("(0 replayed"), std::string::npos) << result.out << result.error;
}

}  // namespace ray_unit_command_test
