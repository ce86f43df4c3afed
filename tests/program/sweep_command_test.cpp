// csx600 sweep, as its users start it.

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
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
