// csx600 estimate, as its users start it.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/command_line.hpp"

namespace estimate_command_test {

using Json = nlohmann::json;
using test_support::CommandResult;
using Words = std::vector<std::string>;

const std::string kScene = CSX600_SCENES_DIR "/cornell_box";

class EstimateCommand : public test_support::CommandLineFixture {
 protected:
  void expect_error(Words arguments, const Words& parts) {
    arguments.insert(arguments.begin(), "estimate");
    const CommandResult wrong = run(arguments);
    EXPECT_EQ(wrong.exit_code, 2) << wrong.error;
    ASSERT_EQ(wrong.error_lines().size(), 1u) << wrong.error;
    for (const std::string& part : parts)
      EXPECT_NE(wrong.error.find(part), std::string::npos) << part << " in: " << wrong.error;
  }
};

TEST_F(EstimateCommand, ShowsTheIntervalBesideTheFullRun) {
  const CommandResult result =
      run({"estimate", kScene, "--size", "8x8", "--set", "chip.pes=16", "--bin-blocks", "4", "--samples",
           "2000", "--within", "3%", "--check", "--json", "e.json"});
  ASSERT_EQ(result.exit_code, 0) << result.error;
  for (const char* const part : {"estimate", "full run", "simulated cycles", "energy, J", "% of the job"})
    EXPECT_NE(result.out.find(part), std::string::npos) << part << " in " << result.out;
  const Json found = Json::parse(read("e.json"));
  EXPECT_EQ(found["format"], "csx600-estimate-1");
  const Json& cycles = found["counters"]["simulated_cycles"];
  EXPECT_EQ(run({"render", kScene, "--size", "8x8", "--set", "chip.pes=16", "--bin-blocks", "4", "--samples",
                 "2000", "--stats", "r.json"})
                .exit_code,
            0);
  EXPECT_EQ(cycles["full_run"], Json::parse(read("r.json"))["simulated_cycles"].get<double>());
  EXPECT_NEAR(cycles["value"].get<double>() / cycles["full_run"].get<double>(), 1, 0.05);
}

TEST_F(EstimateCommand, AShortJobIsRunInFullAndSaysSo) {
  const CommandResult result = run({"estimate", kScene, "--size", "8x8", "--samples", "2"});
  ASSERT_EQ(result.exit_code, 0) << result.error;
  EXPECT_NE(result.out.find("run in full"), std::string::npos) << result.out;
}

TEST_F(EstimateCommand, WrongUses) {
  expect_error({kScene, "--within", "0"}, {"--within", "'0'", "percentage"});
  expect_error({kScene, "--within", "many"}, {"--within", "'many'"});
  expect_error({kScene, "--within", "101%"}, {"--within", "101%"});
  expect_error({kScene, "--samples", "0"}, {"--samples", "0"});
  expect_error({"no_scene"}, {"no_scene"});
}

}  // namespace estimate_command_test
