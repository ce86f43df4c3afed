// `csx600 bench`: what it writes and says, and what it refuses.

#include <cmath>
#include <cstdlib>
#include <map>
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
  /// Rows of a CSV file: cells by the names of their columns.
  std::vector<std::map<std::string, std::string>> csv(const std::string& name) const {
    const auto cells_of = [](const std::string& line) {
      Words cells;
      std::istringstream text(line + ',');
      for (std::string cell; std::getline(text, cell, ',');) cells.push_back(cell);
      return cells;
    };
    std::istringstream lines(read(name));
    std::string line;
    std::getline(lines, line);
    const Words columns = cells_of(line);
    std::vector<std::map<std::string, std::string>> rows;
    while (std::getline(lines, line)) {
      const Words cells = cells_of(line);
      EXPECT_EQ(cells.size(), columns.size());
      rows.emplace_back();
      for (std::size_t i = 0; i < cells.size(); ++i) rows.back()[columns.at(i)] = cells[i];
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
  const auto rows = csv("a.csv");
  ASSERT_EQ(rows.size(), 3u);
  double time_before = 0;
  double energy_before = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto number = [&](const char* column) { return std::stod(rows[i].at(column)); };
    EXPECT_EQ(rows[i].at("scene"), "cornell_box");
    EXPECT_EQ(rows[i].at("estimator"), "per_lobe");
    EXPECT_EQ(rows[i].at("sampler"), "sobol");
    EXPECT_EQ(rows[i].at("n"), "1");
    EXPECT_EQ(number("samples"), 1 << i);
    EXPECT_NEAR(number("rmse"), std::sqrt(number("mse")), 1e-12);
    EXPECT_NEAR(number("native_mse_seconds"), number("mse") * number("native_cpu_seconds"), 1e-12);
    EXPECT_NEAR(number("simulated_mse_seconds"), number("mse") * number("simulated_seconds"), 1e-12);
    EXPECT_NEAR(number("mse_joules"), number("mse") * number("joules"), 1e-12);
    EXPECT_GT(number("simulated_seconds"), time_before);
    EXPECT_GT(number("joules"), energy_before);
    EXPECT_GT(number("flip"), 0);
    EXPECT_LT(number("flip"), 1);
    time_before = number("simulated_seconds");
    energy_before = number("joules");
  }
}

/// One block of look-ahead saves time and energy, and no bit of the image.
TEST_F(BenchCommand, ListsOfOptionsAreCombined) {
  make_reference();
  const CommandResult result = measure({"--csv", "a.csv", "--n", "0,1", "--estimator", "light,mis"});
  EXPECT_EQ(result.exit_code, 0) << result.error;
  for (const char* part : {"cornell_box, n 0, estimator light", "cornell_box, n 1, estimator mis"})
    EXPECT_NE(result.out.find(part), std::string::npos) << part;
  EXPECT_EQ(result.out.find("sampler"), std::string::npos) << "all curves have the same";
  std::map<std::string, std::map<std::string, std::string>> at_four;
  for (const auto& row : csv("a.csv"))
    if (row.at("samples") == "4") at_four[row.at("n") + row.at("estimator")] = row;
  ASSERT_EQ(at_four.size(), 4u);
  for (const char* column : {"mse", "relative_mse", "flip"}) {
    EXPECT_EQ(at_four["0light"][column], at_four["1light"][column]);
    EXPECT_EQ(at_four["0mis"][column], at_four["1mis"][column]);
    EXPECT_NE(at_four["0light"][column], at_four["0mis"][column]);
  }
  for (const char* column : {"simulated_seconds", "joules"})
    EXPECT_GT(std::stod(at_four["0mis"][column]), std::stod(at_four["1mis"][column]));
}

/// The second scene has no light that a ray can hit, only an environment.
TEST_F(BenchCommand, SeveralScenesHaveAReferenceEach) {
  make_reference();
  const std::string environment = std::string(CSX600_SCENES_DIR) + "/environment";
  ASSERT_EQ(
      run({"bench", "reference", environment, "-o", "sky.exr", "--size", "8x6", "--samples", "16"}).exit_code,
      0);
  const Words both = {"bench",     "error", kCornellBox, environment, "--native",
                      "--samples", "2",     "--csv",     "a.csv"};
  const auto with = [&](const Words& more) {
    Words all = both;
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  const CommandResult result = run(with({"--reference", "ref.exr", "--reference", "sky.exr"}));
  EXPECT_EQ(result.exit_code, 0) << result.error;
  const auto rows = csv("a.csv");
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(rows[0].at("scene"), "cornell_box");
  EXPECT_EQ(rows[3].at("scene"), "environment");
  expect_error(with({"--reference", "sky.exr", "--reference", "ref.exr"}),
               {"sky.exr", "environment", "cornell_box"});
  expect_error(with({"--reference", "ref.exr"}), {"--reference", "found 1", "2 scenes"});
}

TEST_F(BenchCommand, TimingMayEndEarlier) {
  make_reference();
  EXPECT_EQ(measure({"--csv", "a.csv", "--timed-samples", "2"}).exit_code, 0);
  const auto rows = csv("a.csv");
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_NE(rows[1].at("joules"), "");
  for (const char* column : {"timed_cpu_seconds", "simulated_seconds", "joules", "mse_joules"})
    EXPECT_EQ(rows[2].at(column), "");
}

/// The error does not depend on the machine, so both runs have the same columns.
TEST_F(BenchCommand, NativeRunsLeaveTheTimedColumnsEmpty) {
  make_reference();
  EXPECT_EQ(measure({"--csv", "a.csv"}).exit_code, 0);
  EXPECT_EQ(measure({"--csv", "b.csv", "--native"}).exit_code, 0);
  const auto both = csv("a.csv");
  const auto native = csv("b.csv");
  ASSERT_EQ(both.size(), 3u);
  ASSERT_EQ(native.size(), 3u);
  for (std::size_t i = 0; i < both.size(); ++i) {
    for (const char* column :
         {"samples", "rmse", "mse", "relative_mse", "flip", "mean_bias_r", "mean_bias_g", "mean_bias_b"})
      EXPECT_EQ(both[i].at(column), native[i].at(column));
    for (const char* column : {"timed_cpu_seconds", "simulated_seconds", "joules", "timed_mse_seconds"})
      EXPECT_EQ(native[i].at(column), "");
  }
}

/// Shadow rays and hits agree, and a reference does not agree with one of another scene.
TEST_F(BenchCommand, ReferencesAreCheckedAgainstASecondEstimator) {
  const CommandResult result = run({"bench", "reference", kCornellBox, "-o", "a.exr", "--size", "8x6",
                                    "--samples", "256", "--check-samples", "4096"});
  EXPECT_EQ(result.exit_code, 0) << result.error;
  for (const char* part : {"difference of the means", "z of 1 tiles"})
    EXPECT_NE(result.out.find(part), std::string::npos) << result.out;
}

TEST_F(BenchCommand, AnImageIsComparedWithAReference) {
  make_reference();
  const Words render = {"render",    kCornellBox, "--native", "--size",  "8x6",
                        "--samples", "4",         "--exr",    "four.exr"};
  ASSERT_EQ(run(render).exit_code, 0);
  ASSERT_EQ(measure({"--csv", "a.csv", "--native"}).exit_code, 0);
  const CommandResult result = run({"bench", "image", "four.exr", "ref.exr", "--scene", kCornellBox});
  EXPECT_EQ(result.exit_code, 0) << result.error;
  std::istringstream lines(result.out.substr(result.out.find("RMSE") + 4));
  double rmse = 0;
  lines >> rmse;
  EXPECT_NEAR(rmse, std::stod(csv("a.csv")[2].at("rmse")), 1e-6) << "that of the curve at 4 samples";
  make_reference("small.exr", "6x6");
  expect_error({"bench", "image", "four.exr", "small.exr"}, {"four.exr", "8 x 6", "6 x 6"});
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
  expect_error(with({"--sampler", "sobol,dice"}), {"--sampler", "'dice'", "philox, sobol"});
  expect_error(with({"--sampler", "sobol,"}), {"--sampler", "''", "philox, sobol"});
  expect_error(with({"--seed", "1,20080812"}), {"--seed", "20080812"});
  expect_error(with({"--timed-samples", "5"}), {"--timed-samples", "5", "power of two"});
  expect_error(with({"--light-sampling", "none"}), {"--light-sampling", "none"});
  expect_error({"bench", "error", kCornellBox, "--reference", "none.exr"}, {"none.exr"});
  expect_error({"bench", "reference", kCornellBox, "-o", "a.exr", "--samples", "1"}, {"--samples"});
  const CommandResult rendered =
      run({"render", kCornellBox, "--native", "--size", "8x6", "--samples", "2", "--exr", "plain.exr"});
  ASSERT_EQ(rendered.exit_code, 0);
  expect_error({"bench", "error", kCornellBox, "--reference", "plain.exr"}, {"plain.exr", "csx600.seed"});
}

TEST_F(BenchCommand, RivalsAreTabledByCoherenceWidthAndTriangles) {
  const CommandResult result = run({"bench", "rivals", "--triangles", "1000", "--widths", "16,32", "--size",
                                    "32x32", "--csv", "rivals.csv"});
  ASSERT_EQ(result.exit_code, 0) << result.error;
  for (const char* part :
       {"16 PEs", "32 PEs", "1st, in tiles", "6th segment", "ray_streams", "is cheaper from"})
    EXPECT_NE(result.out.find(part), std::string::npos) << part;
  const auto rows = csv("rivals.csv");
  ASSERT_EQ(rows.size(), 12u);
  std::map<std::string, double> sixth;
  for (const auto& row : rows) {
    const auto number = [&](const char* column) { return std::stod(row.at(column)); };
    EXPECT_EQ(number("triangles"), 1000);
    if (number("pes") != 32) continue;
    EXPECT_GT(number("first_shuffled"), number("first")) << row.at("traversal");
    sixth[row.at("traversal")] = number("sixth");
  }
  EXPECT_EQ(sixth.size(), 6u);
  EXPECT_LT(sixth["temporary_bin"], sixth["packets"]) << "incoherent rays";
  EXPECT_LT(sixth["ray_streams"], sixth["packets"]) << "lanes are filled by filtering";
}

TEST_F(BenchCommand, RivalsNeedAScenesTrianglesAndAnArraysWidth) {
  expect_error({"bench", "rivals", "--widths", "12"}, {"--widths", "12"});
  expect_error({"bench", "rivals", "--triangles", "5"}, {"--triangles", "5"});
  expect_error({"bench", "rivals", "--size", "0x4"}, {"--size", "0x4"});
}

}  // namespace bench_command_test
