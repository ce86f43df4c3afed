// From the paper's program to the fastest, by small runs.

#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/command_line.hpp"

namespace reproduce_fastest_test {

using Json = nlohmann::json;

class ReproduceFastest : public test_support::CommandLineFixture {};

TEST_F(ReproduceFastest, EachStepIsFasterAndTheImageStays) {
  const auto result = run({"reproduce", CSX600_SCENES_DIR "/cornell_box", "--fastest", "--size", "48x48",
                           "--samples", "4", "--json", "fastest.json"});
  ASSERT_EQ(result.exit_code, 0) << result.error;
  const Json json = Json::parse(read("fastest.json"));
  EXPECT_EQ(json["image"]["equal_counts"], true);
  EXPECT_LT(json["image"]["largest_difference"].get<double>(), 1e-14);
  double before = 0;
  for (const Json& step : json["steps"]) {
    const double now = step["segments_per_second"].get<double>();
    EXPECT_GT(now, before) << step["step"];
    before = now;
    double cycles = 0;
    for (const char* const part : {"kernel", "transfer_call", "wait", "other"})
      cycles += step[part + std::string("_cycles_per_segment")].get<double>();
    EXPECT_NEAR(cycles, 210e6 / now, 0.05 * 210e6 / now) << "all cycles have a cause";
    EXPECT_NE(result.out.find(step["change"].get<std::string>()), std::string::npos);
  }
  EXPECT_GT(before, 20 * json["paper_segments_per_second"].get<double>());
}

TEST_F(ReproduceFastest, IsNoOtherMode) {
  for (const char* const other : {"--image", "--claims"}) {
    const auto result = run({"reproduce", CSX600_SCENES_DIR "/cornell_box", "--fastest", other});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.error_lines().size(), 1U) << result.error;
  }
  const auto result = run({"reproduce", CSX600_SCENES_DIR "/cornell_box", "--plot", "steps.svg"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.error.find("--fastest"), std::string::npos) << result.error;
}

}  // namespace reproduce_fastest_test
