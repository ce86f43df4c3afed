// `csx600 bench`: what it writes and says, and what it refuses.

#include <cmath>
#include <cstdlib>
#include <sstream>

#include "tests/support/command_line.hpp"

namespace bench_command_test {

using test_support::CommandResult;
using Words = std::vector<std::string>;

const std::string kCornellBox = std::string(CSX600_SCENES_DIR) + "/cornell_box";

class BenchCommand : public test_support::CommandLineFixture {
 protected:
  void make_reference(const std::string& name = "ref.exr", const std::string& size = "8x6") {
    const CommandResult result = run(
        {"bench", "reference", kCornellBox, "-o", name, "--size", size, "--samples", "130", "--jobs", "2"});
    ASSERT_EQ(result.exit_code, 0) << result.error;
  }
  CommandResult measure(const Words& more) {
    Words arguments = {"bench", "error", kCornellBox, "--reference", "ref.exr", "--samples", "4"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }
  void expect_error(const Words& arguments, const Words& parts) {
    const Words before = files();
    const CommandResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(files(), before);
    ASSERT_EQ(result.error_lines().size(), 1u) << result.error;
    for (const std::string& part : parts)
      EXPECT_NE(result.error.find(part), std::string::npos) << part << " in " << result.error;
  }
  /// Cells of a CSV file by row; the first row names the columns.
  std::vector<Words> csv(const std::string& name) const {
    std::vector<Words> rows;
    std::istringstream lines(read(name));
    for (std::string line; std::getline(lines, line);) {
      rows.emplace_back();
      line += ',';
      std::istringstream cells(line);
      for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
    }
    return rows;
  }
};

TEST_F(BenchCommand, CurveHasAPointForEachPowerOfTwo) {
  make_reference();
  const CommandResult result = measure({"--csv", "a.csv"});
  EXPECT_EQ(result.exit_code, 0) << result.error;
  EXPECT_EQ(result.error, "");
  for (const char* part : {"RMSE", "slope", "C = MSE x CPU seconds", "simulated"})
    EXPECT_NE(result.out.find(part), std::string::npos) << part;
  const std::vector<Words> rows = csv("a.csv");
  ASSERT_EQ(rows.size(), 4u);
  ASSERT_EQ(rows[0].size(), 12u);
  double time_before = 0;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    ASSERT_EQ(rows[i].size(), 12u);
    EXPECT_EQ(rows[i][0], std::to_string(1 << (i - 1)));
    const double mse = std::stod(rows[i][2]);
    EXPECT_NEAR(std::stod(rows[i][1]), std::sqrt(mse), 1e-12);
    EXPECT_NEAR(std::stod(rows[i][10]), mse * std::stod(rows[i][7]), 1e-12);
    EXPECT_GT(std::stod(rows[i][9]), time_before);
    time_before = std::stod(rows[i][9]);
  }
}

/// The error does not depend on the machine, so both runs have the same columns.
TEST_F(BenchCommand, NativeRunsLeaveTheTimedColumnsEmpty) {
  make_reference();
  EXPECT_EQ(measure({"--csv", "a.csv"}).exit_code, 0);
  EXPECT_EQ(measure({"--csv", "b.csv", "--native"}).exit_code, 0);
  const std::vector<Words> both = csv("a.csv");
  const std::vector<Words> native = csv("b.csv");
  ASSERT_EQ(both.size(), native.size());
  for (std::size_t i = 1; i < both.size(); ++i) {
    for (const std::size_t column : {0u, 1u, 2u, 3u, 4u, 5u, 6u})
      EXPECT_EQ(both[i][column], native[i][column]);
    for (const std::size_t column : {8u, 9u, 11u}) EXPECT_EQ(native[i][column], "");
  }
}

TEST_F(BenchCommand, ReferencesRepeatForAnyNumberOfProcesses) {
  make_reference("a.exr");
  const CommandResult result = run(
      {"bench", "reference", kCornellBox, "-o", "b.exr", "--size", "8x6", "--samples", "130", "--jobs", "1"});
  EXPECT_EQ(result.exit_code, 0) << result.error;
  EXPECT_EQ(read("a.exr"), read("b.exr"));
}

TEST_F(BenchCommand, PlotIsDrawnOrLeftOutWithANote) {
  make_reference();
  const std::string path = std::getenv("PATH");
  setenv("PATH", "/nowhere", 1);
  const CommandResult without = measure({"--csv", "a.csv", "--plot", "a.png", "--native"});
  setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(without.exit_code, 0);
  ASSERT_EQ(without.error_lines().size(), 1u) << without.error;
  EXPECT_NE(without.error.find("gnuplot"), std::string::npos);
  EXPECT_EQ(files(), (Words{"a.csv", "ref.exr"}));
  const CommandResult with = measure({"--plot", "a.png", "--native"});
  EXPECT_EQ(with.exit_code, 0) << with.error;
  if (with.error.empty()) {
    EXPECT_EQ(read("a.png").substr(1, 3), "PNG");
  }
}

TEST_F(BenchCommand, WrongInputIsNamed) {
  make_reference();
  const Words good = {"bench", "error", kCornellBox, "--reference", "ref.exr", "--native"};
  const auto with = [&](const Words& more) {
    Words all = good;
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  expect_error({"bench"}, {"subcommand"});
  expect_error(with({"--samples", "3"}), {"--samples", "3", "power of two"});
  expect_error(with({"--seed", "20080812"}), {"--seed", "20080812"});
  expect_error(with({"--csv", "a.png", "--plot", "./a.png"}), {"--plot", "--csv"});
  expect_error(with({"--csv", "none/a.csv"}), {"none/a.csv"});
  expect_error(with({"--sampler", "dice"}), {"--sampler", "dice"});
  expect_error(with({"--light-sampling", "none"}), {"--light-sampling", "none"});
  expect_error({"bench", "error", kCornellBox, "--reference", "none.exr"}, {"none.exr"});
  expect_error({"bench", "reference", kCornellBox, "-o", "a.exr", "--samples", "1"}, {"--samples"});
  const CommandResult rendered =
      run({"render", kCornellBox, "--native", "--size", "8x6", "--samples", "2", "--exr", "plain.exr"});
  ASSERT_EQ(rendered.exit_code, 0);
  expect_error({"bench", "error", kCornellBox, "--reference", "plain.exr"}, {"plain.exr", "csx600.seed"});
}

}  // namespace bench_command_test
