// --importance, --target-error, --time-budget and --snapshots of `csx600 render` as users give them.

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/command_line.hpp"

namespace sampling_command_test {

using Json = nlohmann::json;
using test_support::CommandResult;
using Words = std::vector<std::string>;

class SamplingCommand : public test_support::CommandLineFixture {
 protected:
  CommandResult render(const Words& more, const std::string& size = "12x10") {
    Words words = {"render", CSX600_SCENES_DIR "/cornell_box", "--size", size};
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
  }
  Json json(const std::string& file) { return Json::parse(read(file)); }

  /// One line, exit code 2, and nothing was written.
  void expect_wrong(const Words& options, const Words& parts, const std::string& size = "12x10") {
    const std::vector<std::string> before = files();
    const CommandResult result = render(options, size);
    EXPECT_EQ(result.exit_code, 2);
    ASSERT_EQ(result.error_lines().size(), 1u) << result.error;
    for (const std::string& part : parts)
      EXPECT_NE(result.error.find(part), std::string::npos) << result.error;
    EXPECT_EQ(files(), before);
  }
};

TEST_F(SamplingCommand, APictureIsAnImportanceMap) {
  ASSERT_EQ(render({"--samples", "4", "--native", "--exr", "map.exr"}).exit_code, 0);
  ASSERT_EQ(render({"--samples", "8", "--importance", "map.exr", "--stats", "chip.json"}).exit_code, 0);
  ASSERT_EQ(
      render({"--samples", "8", "--importance", "map.exr", "--native", "--stats", "native.json"}).exit_code,
      0);
  const Json chip = json("chip.json");
  EXPECT_EQ(chip["image_sha256"], json("native.json")["image_sha256"]);
  EXPECT_EQ(chip["importance"], "map.exr");
  EXPECT_LT(chip["samples_a_pixel"]["fewest"], chip["samples_a_pixel"]["most"]);
  EXPECT_EQ(chip["samples_a_pixel"]["mean"].get<double>() * 120, chip["counts"]["paths"].get<double>());
}

TEST_F(SamplingCommand, PixelsWithoutAPathAreTold) {
  ASSERT_EQ(render({"--samples", "4", "--native", "--exr", "map.exr"}).exit_code, 0);
  const CommandResult result = render({"--samples", "1", "--importance", "map.exr", "--stats", "s.json"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_NE(result.error.find("of 120 pixels have no path and are black"), std::string::npos) << result.error;
  EXPECT_EQ(json("s.json")["samples_a_pixel"]["fewest"], 0);
}

TEST_F(SamplingCommand, RefusesMapsInOneLine) {
  write("map.exr", "no picture");
  expect_wrong({"--importance", "map.exr"}, {"map.exr: cannot be read", "allowed"});
  expect_wrong({"--importance", "none.exr"}, {"none.exr", "allowed"});
  expect_wrong({"--importance", ""}, {"--importance", "allowed"});
  ASSERT_EQ(render({"--samples", "1", "--native", "--exr", "other.exr"}, "8x8").exit_code, 0);
  expect_wrong({"--importance", "other.exr"}, {"other.exr: found", "8x8", "allowed", "12x10"});
  expect_wrong({"--importance", "other.exr", "--exr", "other.exr"}, {"--exr", "is an input (--importance)"},
               "8x8");
  expect_wrong({"--importance", "other.exr", "--samples", "1000000000"}, {"paths needs", "allows"}, "8x8");
}

TEST_F(SamplingCommand, AdaptiveSamplingReachesItsTarget) {
  const CommandResult result = render(
      {"--samples", "2048", "--target-error", "0.1", "--native", "--stats", "s.json", "--exr", "a.exr"});
  ASSERT_EQ(result.exit_code, 0) << result.error;
  const Json statistics = json("s.json");
  EXPECT_EQ(statistics["format"], "csx600-pass-statistics-1");
  EXPECT_EQ(statistics["passes"], statistics["parts"].size());
  EXPECT_LT(statistics["samples_a_pixel"]["mean"], 2048);
  EXPECT_LE(statistics["relative_rmse"], 0.1);
  EXPECT_NE(result.out.find("relative RMSE"), std::string::npos);
}

TEST_F(SamplingCommand, SnapshotsAreThePicturesOfThePasses) {
  ASSERT_EQ(render({"--samples", "4", "--snapshots", "passes", "--exr", "whole.exr", "--stats", "s.json"})
                .exit_code,
            0);
  EXPECT_EQ(files(), (Words{"passes/pass_001.exr", "passes/pass_002.exr", "passes/pass_003.exr", "s.json",
                            "whole.exr"}));
  for (int samples = 1, pass = 1; samples <= 4; samples *= 2, ++pass) {
    const std::string snapshot = "passes/pass_00" + std::to_string(pass) + ".exr";
    // An importance map of the film's size: whole, and with finite values.
    ASSERT_EQ(render({"--importance", snapshot, "--native", "--stats", "t.json"}).exit_code, 0) << snapshot;
  }
  ASSERT_EQ(render({"--samples", "4", "--native", "--stats", "t.json"}).exit_code, 0);
  EXPECT_EQ(json("s.json")["image_sha256"], json("t.json")["image_sha256"]);
}

TEST_F(SamplingCommand, ATimeBudgetIsKept) {
  const CommandResult result = render({"--samples", "100000", "--time-budget", "50ms", "--stats", "s.json"});
  ASSERT_EQ(result.exit_code, 0) << result.error;
  EXPECT_LE(json("s.json")["simulated_seconds"], 0.05);
  EXPECT_EQ(json("s.json")["out_of_time"], true);
  ASSERT_EQ(
      render({"--samples", "100000", "--time-budget", "100ms", "--native", "--stats", "s.json"}).exit_code,
      0);
  EXPECT_EQ(json("s.json")["out_of_time"], true);
  ASSERT_EQ(
      render({"--samples", "2", "--time-budget", "10min", "--budget-clock", "simulator", "--stats", "s.json"})
          .exit_code,
      0);
  EXPECT_EQ(json("s.json")["out_of_time"], false);
}

TEST_F(SamplingCommand, RefusesWrongOptionsInOneLine) {
  for (const char* const time : {"", "2", "0s", "-1s", "nans", "1h"})
    expect_wrong({"--time-budget", time},
                 {"--time-budget: found '" + std::string(time) + "'", "allowed", "500ms"});
  for (const char* const error : {"0", "-1", "nan", "inf", "x", ""})
    expect_wrong({"--target-error", error},
                 {"--target-error: found '" + std::string(error) + "'", "allowed"});
  expect_wrong({"--budget-clock", "chip"}, {"--budget-clock", "--time-budget"});
  expect_wrong({"--budget-clock", "sundial", "--time-budget", "1s"}, {"--budget-clock", "chip, simulator"});
  expect_wrong({"--budget-clock", "chip", "--time-budget", "1s", "--native"}, {"--budget-clock", "--native"});
  expect_wrong({"--target-error", "0.1", "--timeline", "t.html"}, {"--timeline", "one pass"});
  write("file", "");
  expect_wrong({"--snapshots", "file"}, {"--snapshots: found 'file'", "allowed"});
  expect_wrong({"--snapshots", ""}, {"--snapshots", "allowed"});
}

/// The cell of a column in the last row of a table.
double last(const std::string& csv, const std::string& column) {
  std::vector<Words> rows;
  std::istringstream lines(csv);
  for (std::string line; std::getline(lines, line);) {
    rows.emplace_back();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
  }
  const auto found = std::find(rows.front().begin(), rows.front().end(), column);
  return std::stod(rows.back().at(std::size_t(found - rows.front().begin())));
}

TEST_F(SamplingCommand, AdaptiveSamplingSavesPathsWhereASmallPartIsHard) {
  const std::string scene = CSX600_SCENES_DIR "/niche";
  ASSERT_EQ(
      run({"bench", "reference", scene, "--size", "24x24", "--samples", "2048", "-o", "r.exr"}).exit_code, 0);
  const Words words = {"bench", "adaptive", scene,       "--reference", "r.exr", "--targets",
                       "0.2",   "--native", "--samples", "512",         "--csv", "a.csv"};
  ASSERT_EQ(run(words).exit_code, 0);
  EXPECT_EQ(last(read("a.csv"), "target_error"), 0.2);
  EXPECT_GT(last(read("a.csv"), "paths_gain_by_relative_rmse"), 1.5);
  EXPECT_LT(last(read("a.csv"), "relative_rmse"), 0.2);
}

}  // namespace sampling_command_test
