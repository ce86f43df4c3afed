// Boards of several chips as users ask for them: what is written of each chip, and what is refused.

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/support/command_line.hpp"

namespace board_command_test {

using Json = nlohmann::json;
using test_support::CommandResult;
using Words = std::vector<std::string>;

const std::string kCornellBox = std::string(CSX600_SCENES_DIR) + "/cornell_box";

class BoardCommand : public test_support::CommandLineFixture {
 protected:
  Json statistics(const Words& more) {
    Words arguments = {"render", kCornellBox, "--size", "8x6", "--samples", "4", "--stats", "s.json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const CommandResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.error;
    return Json::parse(read("s.json"));
  }
  void expect_error(const Words& arguments, const Words& parts) {
    const CommandResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.out, "");
    ASSERT_EQ(result.error_lines().size(), 1u) << result.error;
    for (const std::string& part : parts)
      EXPECT_NE(result.error.find(part), std::string::npos) << part << " in " << result.error;
  }
};

TEST_F(BoardCommand, StatisticsAreOfTheBoardAndOfEachChip) {
  const Json one = statistics({});
  EXPECT_FALSE(one.contains("chips"));
  const Json two = statistics({"--set", "board.chips=2"});
  EXPECT_EQ(two["image_sha256"], one["image_sha256"]);
  EXPECT_EQ(two["segments"], one["segments"]);
  ASSERT_EQ(two["chips"].size(), 2u);
  const Json& first = two["chips"]["csx600_0"];
  const Json& second = two["chips"]["csx600_1"];
  for (const char* key : {"/pio/bytes_mono_to_poly", "/ddr/bytes_read", "/host_link/bytes_uploaded",
                          "/control_unit/mono_instructions"}) {
    const Json::json_pointer pointer(key);
    EXPECT_EQ(two["chip"][pointer].get<std::uint64_t>(),
              first[pointer].get<std::uint64_t>() + second[pointer].get<std::uint64_t>())
        << key;
  }
  EXPECT_EQ(run({"compare", "s.json", "s.json"}).exit_code, 0);
  const CommandResult text = run({"stats", "s.json"});
  EXPECT_NE(text.out.find("chips.csx600_1.ddr"), std::string::npos);
}

TEST_F(BoardCommand, EachChipHasItsWaves) {
  statistics({"--set", "board.chips=2", "--waves", "a.vcd", "--transactions", "t.jsonl"});
  const Words found = files();
  for (const char* file : {"a.csx600_0.vcd", "a.csx600_1.vcd", "a.csx600_0.gtkw", "a.csx600_1.gtkw",
                           "t.csx600_0.jsonl", "t.csx600_1.jsonl"})
    EXPECT_EQ(std::count(found.begin(), found.end(), file), 1) << file;
  EXPECT_NE(read("a.csx600_1.vcd").find("$scope module csx600_1 $end"), std::string::npos);
}

/// Points of a board are run in full, those of one chip replayed.
TEST_F(BoardCommand, IsAnAxisOfSweeps) {
  write("sweep.toml", "scene = \"" + kCornellBox +
                          "\"\nsize = \"8x6\"\nsamples = 4\n[[axis]]\nboard.chips = [1, 2]\n"
                          "[[axis]]\npio.setup_cycles = [100, 200, 300]\n");
  const CommandResult result = run({"sweep", "sweep.toml"});
  ASSERT_EQ(result.exit_code, 0) << result.error;
  const Json one = Json::parse(read("sweep.sweep/sweep.json"));
  std::vector<double> cycles;
  for (const Json& point : one["points"]) {
    ASSERT_EQ(point["status"], "done");
    cycles.push_back(point["results"]["simulated_cycles"]);
  }
  ASSERT_EQ(cycles.size(), 6u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_LT(cycles[3 + i], cycles[i]);
  const Json alone = statistics({"--set", "board.chips=2", "--set", "pio.setup_cycles=200"});
  EXPECT_EQ(alone["simulated_cycles"].get<double>(), cycles[4]);
}

TEST_F(BoardCommand, NumbersThatNoBoardHasAreRefused) {
  for (const char* chips : {"0", "3", "8", "-1", "two"})
    expect_error({"render", kCornellBox, "--set", "board.chips=" + std::string(chips)},
                 {"board.chips: found '" + std::string(chips) + "'", "allowed: a power of two from 1 to 4"});
  expect_error({"bench", "board", kCornellBox, "--chips", "1,3"}, {"--chips", "found '3'"});
  expect_error({"render", kCornellBox, "--set", "chip.arrays=0"}, {"chip.arrays: found '0'"});
  expect_error({"render", kCornellBox, "--set", "board.bridge_bytes_per_cycle=0"}, {"found '0'"});
  expect_error({"render", kCornellBox, "--set", "board.bridge_clock_hz=0"}, {"found '0'"});
  expect_error({"render", kCornellBox, "--set", "on_chip_sram.size_bytes=131072", "--set",
                "on_chip_sram.first_address=65536"},
               {"on_chip_sram.first_address: found '65536'", "ddr.size_bytes"});
  expect_error({"run", std::string(CSX600_PLUG_INS) + "/libsaxpy.so", "--set", "board.chips=2"},
               {"board.chips: found 2; allowed: 1"});
  expect_error({"render", kCornellBox, "--size", "1x1", "--samples", "1", "--set", "board.chips=2"},
               {"board.chips: found 2 arrays for 1 paths"});
}

}  // namespace board_command_test
