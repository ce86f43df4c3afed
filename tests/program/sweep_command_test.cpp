// csx600 sweep, as its users start it.

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <thread>

#include "tests/support/command_line.hpp"

namespace sweep_command_test {

using Json = nlohmann::json;
using test_support::CommandResult;
using Words = std::vector<std::string>;

const std::string kBase = "scene = \"" CSX600_SCENES_DIR "/cornell_box\"\nsize = \"8x6\"\nsamples = 2\n";

class SweepCommand : public test_support::CommandLineFixture {
 protected:
  std::vector<std::string> lines(const std::string& file) {
    std::vector<std::string> found;
    std::istringstream text(read(file));
    for (std::string line; std::getline(text, line);) found.push_back(line);
    return found;
  }
  std::size_t finished_points(const std::string& directory) {
    const auto names = files();
    if (std::find(names.begin(), names.end(), directory + "/points.jsonl") == names.end()) return 0;
    const std::string text = read(directory + "/points.jsonl");
    const auto ends = std::size_t(std::count(text.begin(), text.end(), '\n'));
    return ends == 0 ? 0 : ends - 1;
  }
  void expect_error(const Words& arguments, const Words& parts, int exit_code = 2) {
    const CommandResult result = run(arguments);
    EXPECT_EQ(result.exit_code, exit_code) << result.error;
    ASSERT_EQ(result.error_lines().size(), 1u) << result.error;
    for (const std::string& part : parts)
      EXPECT_NE(result.error.find(part), std::string::npos) << part << " in: " << result.error;
  }
};

TEST_F(SweepCommand, ReplayedPointsEqualFullOnesInEveryColumn) {
  write("s.toml", kBase +
                      "[[axis]]\nfirmware.program = [\"segments\", \"full\"]\n"
                      "[[axis]]\nchip.clock_hz = [2e8, 3e8]\n"
                      "[[axis]]\npio.setup_cycles = [0, 400]\nddr.banks = [1, 8]\n");
  ASSERT_EQ(run({"sweep", "s.toml", "-o", "replayed"}).exit_code, 0);
  const CommandResult full = run({"sweep", "s.toml", "-o", "full", "--full", "--jobs", "3"});
  EXPECT_NE(full.out.find("0 replayed"), std::string::npos) << full.out;
  EXPECT_EQ(read("replayed/sweep.csv"), read("full/sweep.csv"));
  EXPECT_EQ(read("replayed/sweep.json"), read("full/sweep.json"));
  EXPECT_EQ(lines("full/sweep.csv").size(), 9u);
  const Json sweep = Json::parse(read("full/sweep.json"));
  EXPECT_EQ(sweep["points"][7]["inputs"]["ddr.banks"], 8);
  EXPECT_GT(sweep["points"][7]["results"]["simulated_cycles"],
            sweep["points"][6]["results"]["simulated_cycles"]);
}

TEST_F(SweepCommand, ChoosesWhatRenderChoosesAndSaysSo) {
  ASSERT_EQ(run({"scene", "blob", "--triangles", "2000", "-o", "blob"}).exit_code, 0);
  write("s.toml",
        "scene = \"blob\"\nsize = \"8x6\"\nsamples = 1\nfirmware.node_width = 4\n[[axis]]\n"
        "chip.pes = [32, 96]\n");
  ASSERT_EQ(run({"sweep", "s.toml", "-o", "out"}).exit_code, 0);
  const Json points = Json::parse(read("out/sweep.json"))["points"];
  for (const Json& point : points) {
    const std::string pes = std::to_string(point["inputs"]["chip.pes"].get<int>());
    ASSERT_EQ(run({"render", "blob", "--size", "8x6", "--samples", "1", "--node-width", "4", "--set",
                   "chip.pes=" + pes, "--stats", "render.json"})
                  .exit_code,
              0);
    const Json rendered = Json::parse(read("render.json"));
    EXPECT_EQ(rendered["firmware"]["traversal"], "refill");
    EXPECT_EQ(point["chosen"]["firmware.traversal"], "refill");
    EXPECT_FALSE(point["chosen"].contains("firmware.node_width"));
    EXPECT_EQ(point["results"]["simulated_cycles"], rendered["simulated_cycles"]) << pes;
  }
  EXPECT_NE(lines("out/sweep.csv")[0].find(",firmware.traversal,"), std::string::npos);
}

TEST_F(SweepCommand, GoesOnAfterAKillAndComputesNothingTwice) {
  write("s.toml",
        "scene = \"" CSX600_SCENES_DIR
        "/cornell_box\"\nsize = \"32x24\"\nsamples = 16\n[[axis]]\npio.setup_cycles = { from = 1, to = 60, "
        "step = 1 }\n");
  const pid_t child = start({"sweep", "s.toml", "-o", "killed", "--jobs", "2"});
  for (int tries = 0; finished_points("killed") < 5 && tries < 2000; ++tries)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  kill(child, SIGKILL);
  EXPECT_EQ(finish(child).exit_code, -1);
  const std::size_t before = finished_points("killed");
  ASSERT_GE(before, 5u);
  ASSERT_LT(before, 60u) << "too fast to be killed";
  const CommandResult rest = run({"sweep", "s.toml", "-o", "killed"});
  EXPECT_EQ(rest.exit_code, 0) << rest.error;
  std::set<std::string> ids;
  for (const std::string& line : lines("killed/points.jsonl"))
    if (const Json json = Json::parse(line); json.contains("id")) {
      EXPECT_TRUE(ids.insert(json["id"]).second) << json["id"];
    }
  EXPECT_EQ(ids.size(), 60u);
  ASSERT_EQ(run({"sweep", "s.toml", "-o", "whole"}).exit_code, 0);
  EXPECT_EQ(read("killed/sweep.csv"), read("whole/sweep.csv"));
  const std::string log = read("whole/points.jsonl");
  EXPECT_NE(run({"sweep", "s.toml", "-o", "whole"}).out.find("60 were there"), std::string::npos);
  EXPECT_EQ(read("whole/points.jsonl"), log);
}

TEST_F(SweepCommand, APointThatFailsIsRecordedAndTheRestRuns) {
  write("s.toml",
        kBase + "firmware.n = 2\n[[axis]]\npoly.sram_bytes = [6144, 2048]\n[[axis]]\nddr.banks = [2, 4]\n");
  const CommandResult result = run({"sweep", "s.toml", "-o", "out"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.out.find("2 done"), std::string::npos) << result.out;
  EXPECT_NE(result.error.find("poly SRAM overflow"), std::string::npos) << result.error;
  const Json points = Json::parse(read("out/sweep.json"))["points"];
  EXPECT_EQ(points[1]["status"], "done");
  EXPECT_EQ(points[2]["status"], "failed");
  EXPECT_NE(points[2]["error"].get<std::string>().find("poly SRAM overflow"), std::string::npos);
  EXPECT_EQ(finished_points("out"), 4u);
  run({"sweep", "s.toml", "-o", "out"});
  EXPECT_EQ(finished_points("out"), 4u);
  run({"sweep", "s.toml", "-o", "out", "--retry-failed"});
  EXPECT_EQ(finished_points("out"), 6u);
}

/// Rows of a table: cells by the names of its columns, which must differ.
std::vector<std::map<std::string, std::string>> rows_of(const Words& lines) {
  const auto cells = [](const std::string& line) {
    Words found;
    std::istringstream text(line);
    for (std::string cell; std::getline(text, cell, ',');) found.push_back(cell);
    return found;
  };
  const Words names = cells(lines.at(0));
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size());
  std::vector<std::map<std::string, std::string>> rows;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const Words row = cells(lines[i]);
    rows.emplace_back();
    for (std::size_t k = 0; k < row.size(); ++k) rows.back()[names.at(k)] = row[k];
  }
  return rows;
}

TEST_F(SweepCommand, ConstraintsAndDerivedColumns) {
  write("s.toml",
        kBase +
            "[constraint]\nsram = \"chip.pes * poly.sram_bytes < 590000\"\n"
            "time = \"simulated_cycles * (pio.setup_cycles == 9) < 1\"\n"
            "[derived]\nper_ray = { expression = \"simulated_cycles / rays\", unit = \"cycles/ray\" }\n"
            "[[axis]]\nchip.pes = [32, 128]\n[[axis]]\npio.setup_cycles = [9, 10]\n");
  const CommandResult result = run({"sweep", "s.toml", "-o", "out"});
  EXPECT_EQ(result.exit_code, 0) << result.error;
  EXPECT_NE(result.out.find("2 points were not run, 1 that were run"), std::string::npos) << result.out;
  EXPECT_EQ(finished_points("out"), 2u);
  const auto rows = rows_of(lines("out/sweep.csv"));
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(rows[0].at("status"), "unmet");
  EXPECT_EQ(rows[1].at("status"), "done");
  EXPECT_EQ(rows[2].at("status"), "excluded");
  EXPECT_EQ(rows[3].at("status"), "excluded");
  EXPECT_EQ(rows[2].at("error"), "constraint sram is not met: chip.pes * poly.sram_bytes < 590000");
  for (const std::size_t run : {0, 1})
    EXPECT_DOUBLE_EQ(std::stod(rows[run].at("per_ray")),
                     std::stod(rows[run].at("simulated_cycles")) / std::stod(rows[run].at("rays")));
}

TEST_F(SweepCommand, ADictionaryHasEveryColumnOnceAndKernelsAreOnRequest) {
  write("s.toml", kBase + "[[axis]]\nchip.pes = [32]\n[[axis]]\nsamples = [1]\n[derived]\nx = \"rays\"\n");
  // `samples` may be on an axis only if it is no base value.
  write("s.toml", std::string(read("s.toml")).erase(read("s.toml").find("samples = 2\n"), 12));
  ASSERT_EQ(run({"sweep", "s.toml", "-o", "out"}).exit_code, 0);
  const auto columns_of = [&] {
    Words names;
    for (const std::string& line : lines("out/columns.csv")) names.push_back(line.substr(0, line.find(',')));
    names.erase(names.begin());
    return names;
  };
  const Words columns = columns_of();
  std::string header;
  for (const std::string& name : columns) header += (header.empty() ? "" : ",") + name;
  EXPECT_EQ(lines("out/sweep.csv")[0], header);
  EXPECT_NE(read("out/columns.csv").find("\nsimulated_seconds,result,s,"), std::string::npos);
  EXPECT_NE(read("out/columns.csv").find("\nx,derived,,rays\n"), std::string::npos);
  EXPECT_EQ(header.find(".kernels."), std::string::npos);
  ASSERT_EQ(run({"sweep", "s.toml", "-o", "out", "--kernels"}).exit_code, 0);
  EXPECT_GT(columns_of().size(), columns.size() + 50);
  EXPECT_NE(lines("out/sweep.csv")[0].find(".kernels.intersect.cycles"), std::string::npos);
}

TEST_F(SweepCommand, ExpressionsThatMeanNothingAreRefused) {
  const auto refused = [&](const std::string& expression, const std::string& part) {
    write("s.toml", kBase + "[[axis]]\nchip.pes = [32, 96]\n" + expression + "\n");
    expect_error({"sweep", "s.toml"}, {"s.toml", part});
  };
  refused("[constraint]\na = \"chip.pes = 32\"", "operator \"=\"");
  refused("[constraint]\na = \"chip.pe < 32\"", "did you mean 'chip.pes'");
  refused("[constraint]\na = \"chip.pes <\"", "constraint.a");
  refused("[constraint]\na = \"\"", "constraint.a");
  refused("[constraint]\na = \"scene > 1\"", "parameters that are numbers");
  refused("[constraint]\na = \"chip.pes > 1000\"", "no point meets");
  refused("[constraint]\na = 5", "constraint.a");
  refused("[derived]\nrays = \"1\"", "name of a result");
  refused("[derived]\nx = { expression = \"1\", units = \"s\" }", "'units'");
  write("s.toml", "constraint = 3\n" + kBase + "[[axis]]\nchip.pes = [32, 96]\n");
  expect_error({"sweep", "s.toml"}, {"s.toml:1", "[constraint]"});
  EXPECT_EQ(files(), (Words{"s.toml"}));
}

TEST_F(SweepCommand, NewValuesOfAnAxisAreAllThatIsRun) {
  write("s.toml", kBase + "[[axis]]\npio.setup_cycles = [1, 2]\n");
  run({"sweep", "s.toml"});
  write("s.toml", kBase + "[[axis]]\npio.setup_cycles = [1, 2, 3]\n");
  const CommandResult result = run({"sweep", "s.toml"});
  EXPECT_NE(result.out.find("3 done"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("2 were there"), std::string::npos) << result.out;
}

TEST_F(SweepCommand, AnInterruptLeavesWhatIsFinished) {
  write("s.toml", kBase + "[[axis]]\npio.setup_cycles = { from = 1, to = 3000, step = 1 }\n");
  const pid_t child = start({"sweep", "s.toml", "-o", "out"});
  for (int tries = 0; finished_points("out") < 3 && tries < 2000; ++tries)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  kill(child, SIGTERM);
  const CommandResult result = finish(child);
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.error.find("the same command goes on"), std::string::npos) << result.error;
  EXPECT_EQ(lines("out/sweep.csv").size(), 3001u);
}

TEST_F(SweepCommand, BadInput) {
  expect_error({"sweep", "none.toml"}, {"none.toml", "cannot be read"});
  write("bad.toml", kBase + "[[axis]]\npio.setup = [1]\n");
  expect_error({"sweep", "bad.toml"}, {"bad.toml:5", "'pio.setup'"});
  write("s.toml", kBase + "[[axis]]\npio.setup_cycles = [1]\n");
  expect_error({"sweep", "s.toml", "--set", "x=1"}, {"--set", "'x'"});
  expect_error({"sweep", "s.toml", "--set", "samples"}, {"--set", "key=value"});
  expect_error({"sweep", "s.toml", "-o", "/proc/nowhere"}, {"/proc/nowhere", "output directory"});
  write("file", "");
  expect_error({"sweep", "s.toml", "-o", "file"}, {"file", "directory"});
  write("other/points.jsonl", "{\"format\":\"csx600-sweep-points-2\",\"build\":\"0\"}\n");
  expect_error({"sweep", "s.toml", "-o", "other"}, {"other/points.jsonl:1", "another build"});
  write("old/points.jsonl", "{\"format\":\"csx600-sweep-points-1\",\"build\":\"0\"}\n");
  expect_error({"sweep", "s.toml", "-o", "old"},
               {"old/points.jsonl:1", "csx600-sweep-points-1", "another directory"});
  EXPECT_EQ(files(), (Words{"bad.toml", "file", "old/points.jsonl", "other/points.jsonl", "s.toml"}));
}

}  // namespace sweep_command_test
