// Sweeps and golden grids over firmware that was built outside the tree.

#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "tests/support/command_line.hpp"

namespace plug_in_sweep_test {

using Json = nlohmann::json;
using test_support::CommandResult;
using Words = std::vector<std::string>;

std::string library(const std::string& name) {
  return std::string(CSX600_PLUG_INS) + "/lib" + name + ".so";
}
std::string firmware(const std::string& name) {
  return "firmware = \"" + library(name) + "\"\n";
}

class PlugInSweep : public test_support::CommandLineFixture {
 protected:
  Json points(const std::string& directory) { return Json::parse(read(directory + "/sweep.json"))["points"]; }
  void expect_refusal(const std::string& sweep, const Words& parts) {
    write("refused.toml", sweep);
    const CommandResult result = run({"sweep", "refused.toml"});
    EXPECT_EQ(result.exit_code, 2) << result.error;
    ASSERT_EQ(result.error_lines().size(), 1u) << result.error;
    for (const std::string& part : parts)
      EXPECT_NE(result.error.find(part), std::string::npos) << part << " in: " << result.error;
  }
  std::size_t lines(const std::string& file) {
    const std::string text = std::filesystem::exists(directory() / file) ? read(file) : "";
    return std::size_t(std::count(text.begin(), text.end(), '\n'));
  }
};

TEST_F(PlugInSweep, ReplayedPointsEqualFullOnesInEveryColumn) {
  write("s.toml", firmware("saxpy") +
                      "option.a = 0.5\n[[axis]]\noption.blocks = [1, 5]\n"
                      "[[axis]]\npio.setup_cycles = [0, 600]\nddr.banks = [1, 8]\n"
                      "[[axis]]\ntiming = [\"lt\", \"at\"]\n");
  const CommandResult replayed = run({"sweep", "s.toml", "-o", "replayed"});
  EXPECT_NE(replayed.out.find("8 done (8 replayed"), std::string::npos) << replayed.out << replayed.error;
  ASSERT_EQ(run({"sweep", "s.toml", "-o", "full", "--full"}).exit_code, 0);
  EXPECT_EQ(read("replayed/sweep.csv"), read("full/sweep.csv"));
  EXPECT_EQ(read("replayed/sweep.json"), read("full/sweep.json"));
  // The same as `csx600 run` says of the same run.
  ASSERT_EQ(run({"run", "--stats", "run.json", "--set", "pio.setup_cycles=600", "--set", "ddr.banks=8",
                 library("saxpy"), "--", "--a", "0.5", "--blocks", "5"})
                .exit_code,
            0);
  const Json alone = Json::parse(read("run.json"));
  const Json point = points("full")[6];
  EXPECT_EQ(point["inputs"]["option.blocks"], 5);
  EXPECT_EQ(point["inputs"]["timing"], "lt");
  EXPECT_EQ(point["results"]["simulated_cycles"], alone["simulated_cycles"]);
  EXPECT_EQ(point["results"]["work.amount"], 5 * 96 * 16);
  EXPECT_EQ(point["results"]["work.per_second"], alone["work"]["per_second"]);
  EXPECT_EQ(point["results"]["chip.energy.joules"], alone["chip"]["energy"]["joules"]);
}

TEST_F(PlugInSweep, ThreadsAreRunInFullSinceTheirOrderDependsOnTheChip) {
  write("s.toml",
        "firmware = \"stream\"\noption.blocks = 3\n[[axis]]\noption.threads = [0, 1]\n"
        "[[axis]]\npio.setup_cycles = [0, 100]\n");
  const CommandResult result = run({"sweep", "s.toml", "-o", "out"});
  EXPECT_NE(result.out.find("4 done (2 replayed"), std::string::npos) << result.out << result.error;
}

TEST_F(PlugInSweep, CountersOfTheFirmwareAreColumnsAndAFailedCheckSaysWhy) {
  write("s.toml", firmware("faults") + "[[axis]]\noption.fault = [0, 1, 8]\n");
  const CommandResult result = run({"sweep", "s.toml", "-o", "out"});
  EXPECT_EQ(result.exit_code, 1);
  const Json found = points("out");
  EXPECT_EQ(found[0]["results"]["firmware.sum"], 95 * 96);  // twice the numbers 0 to 95
  EXPECT_EQ(found[1]["status"], "failed");
  EXPECT_EQ(found[1]["error"], "faults: number 1 is wrong");
  EXPECT_EQ(found[2]["error"], "faults: a kernel has thrown");
}

TEST_F(PlugInSweep, APointThatNeverEndsFailsAtTheTimeLimit) {
  write("s.toml",
        firmware("faults") + "[[axis]]\noption.fault = [7, 0]\n[[axis]]\npio.setup_cycles = [1, 2]\n");
  const CommandResult result = run({"sweep", "s.toml", "-o", "out", "--time-limit", "1"});
  EXPECT_EQ(result.exit_code, 1);
  const Json found = points("out");
  EXPECT_EQ(found[0]["status"], "failed");
  EXPECT_EQ(found[1]["status"], "failed");
  EXPECT_EQ(found[2]["status"], "done") << found[2];
  EXPECT_EQ(found[3]["status"], "done");
}

TEST_F(PlugInSweep, GoesOnAfterAKill) {
  write("s.toml", firmware("fft1d") +
                      "option.batches = 12\n[[axis]]\npio.setup_cycles = { from = 1, to = 60, step = 1 }\n");
  const pid_t child = start({"sweep", "s.toml", "-o", "killed", "--full", "--jobs", "2"});
  for (int tries = 0; lines("killed/points.jsonl") < 5 && tries < 2000; ++tries)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  kill(child, SIGKILL);
  EXPECT_EQ(finish(child).exit_code, -1);
  ASSERT_LT(lines("killed/points.jsonl"), 60u) << "too fast to be killed";
  EXPECT_EQ(run({"sweep", "s.toml", "-o", "killed"}).exit_code, 0);
  ASSERT_EQ(run({"sweep", "s.toml", "-o", "whole"}).exit_code, 0);
  EXPECT_EQ(read("killed/sweep.csv"), read("whole/sweep.csv"));
}

TEST_F(PlugInSweep, ResultsOfAnotherBuildOfTheFirmwareAreRefused) {
  std::filesystem::copy_file(library("saxpy"), directory() / "libmine.so");
  write("s.toml", "firmware = \"libmine.so\"\n[[axis]]\npio.setup_cycles = [1, 2]\n");
  ASSERT_EQ(run({"sweep", "s.toml", "-o", "out"}).exit_code, 0);
  EXPECT_NE(run({"sweep", "s.toml", "-o", "out"}).out.find("2 were there"), std::string::npos);
  std::filesystem::copy_file(library("fft1d"), directory() / "libmine.so",
                             std::filesystem::copy_options::overwrite_existing);
  const CommandResult result = run({"sweep", "s.toml", "-o", "out"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.error.find("another build of csx600 or of the firmware"), std::string::npos)
      << result.error;
}

TEST_F(PlugInSweep, RefusesWhatTheFirmwareDoesNotAllow) {
  expect_refusal(
      firmware("saxpy") + "option.block = 3\n",
      {"refused.toml:2", "'option.block'", "option.blocks, option.a", "did you mean 'option.blocks'?"});
  expect_refusal(firmware("saxpy") + "[[axis]]\noption.blocks = [1, 4097]\n",
                 {"refused.toml:3: option.blocks: found '4097', allowed is 1..4096"});
  expect_refusal(firmware("saxpy") + "samples = 3\n", {"refused.toml:2", "'samples' beside a firmware"});
  expect_refusal(firmware("saxpy") + "chip = \"csx6\"\n", {"csx6"});
  expect_refusal("option.blocks = 3\n", {"refused.toml:1", "without a firmware"});
  expect_refusal("firmware = \"libnone.so\"\n", {"refused.toml:1", "libnone.so"});
  expect_refusal("firmware = \"dgem\"\n", {"refused.toml:1", "did you mean 'dgemm'?"});
  expect_refusal(firmware("other_version"), {"refused.toml:1", "of version 0.0.1"});
  EXPECT_EQ(files(), (Words{"refused.toml"}));
}

TEST_F(PlugInSweep, ReportShowsItsWork) {
  write("s.toml", firmware("saxpy") + "[[axis]]\noption.blocks = [1, 5]\n");
  ASSERT_EQ(run({"sweep", "s.toml", "-o", "out"}).exit_code, 0);
  EXPECT_EQ(run({"report", "out", "-o", "page.html"}).exit_code, 0);
  EXPECT_NE(read("page.html").find("work.per_second"), std::string::npos);
}

TEST_F(PlugInSweep, GoldenGridsKeepWhatTheChipAndTheFirmwareCounted) {
  write("golden/grid.toml", "[[grid]]\nfirmware = [\"" + library("faults") +
                                "\", \"monte_carlo\"]\n"
                                "chip = [\"csx600\"]\ntiming = [\"lt\", \"at\"]\n");
  EXPECT_EQ(run({"golden", "golden", "--update"}).exit_code, 0);
  EXPECT_EQ(files(),
            (Words{"golden/faults-csx600.csv", "golden/grid.toml", "golden/monte_carlo-csx600.csv"}));
  const std::string table = read("golden/faults-csx600.csv");
  EXPECT_EQ(table.rfind("key,lt,at\n", 0), 0u) << table.substr(0, 100);
  EXPECT_NE(table.find("\nfirmware.counters.sum.value,9120.0,9120.0\n"), std::string::npos) << table;
  EXPECT_NE(table.find("\nchip.host_link.bytes_uploaded,768,768\n"), std::string::npos);
  const CommandResult again = run({"golden", "golden"});
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_NE(again.out.find("4 runs, no counter moved"), std::string::npos) << again.out;
  write("golden/grid.toml", "[[grid]]\nfirmware = [\"" + library("faults") + "\"]\noption.falt = [0]\n");
  const CommandResult refused = run({"golden", "golden"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.error.find("grid.toml:3: found 'option.falt'"), std::string::npos) << refused.error;
}

}  // namespace plug_in_sweep_test
