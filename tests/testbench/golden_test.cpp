#include "testbench/golden/golden.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "testbench/system/error.hpp"

namespace golden_test {

using testbench::GoldenGrid;
using testbench::GoldenTables;

class Golden : public testing::Test {
 protected:
  Golden() : directory_(std::filesystem::path(testing::TempDir()) / ("golden_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(directory_);
  }
  ~Golden() override { std::filesystem::remove_all(directory_); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(directory_ / name) << text;
  }
  std::string read(const std::string& name) const {
    std::ostringstream text;
    text << std::ifstream(directory_ / name).rdbuf();
    return text.str();
  }
  GoldenGrid grid(const std::string& text) const {
    write("grid.toml", text);
    return testbench::read_golden_grid(directory_);
  }
  std::string refusal(const std::string& text) const {
    try {
      grid(text);
      return "";
    } catch (const testbench::InputError& error) {
      return std::string(error.what()).substr(directory_.string().size() + 1);
    }
  }

  std::filesystem::path directory_;
};

const std::string kHead = "width = 6\nheight = 4\nsamples = 1\n";

testbench::GoldenTables run(const GoldenGrid& grid, int jobs) {
  return testbench::run_golden(grid, testbench::load_golden_scenes(grid), jobs);
}

std::string product(const std::string& more) {
  return "[[grid]]\nscene = [\"" + std::string(CSX600_SCENES_DIR) + "/cornell_box\"]\n" + more;
}
const std::string kTwoChips = product(
    "chip = [\"csx600\", \"paper\"]\nfirmware.program = [\"segments\", \"full\"]\nfirmware.n = [0, 2]\n"
    "firmware.buffer = [\"loads\"]\ntiming = [\"lt\", \"at\"]\n");
const std::string kOneRun = product(
    "chip = [\"csx600\"]\nfirmware.program = [\"full\"]\nfirmware.n = [1]\nfirmware.buffer = "
    "[\"both\"]\ntiming = [\"lt\"]\n");

TEST_F(Golden, GridIsEveryCombination) {
  const GoldenGrid read = grid(kHead + kTwoChips + kOneRun + kTwoChips);  // each run appears once
  EXPECT_EQ(read.film.width, 6);
  ASSERT_EQ(read.runs.size(), 17u);
  EXPECT_EQ(read.runs[0].file, "cornell_box-csx600.csv");
  EXPECT_EQ(read.runs[0].name, "segments n0 loads lt");
  EXPECT_EQ(read.runs[15].file, "cornell_box-paper.csv");
  EXPECT_EQ(read.runs[15].name, "full n2 loads at");
  EXPECT_EQ(read.runs[15].options.chip.preset, "paper");
  EXPECT_EQ(read.runs[15].options.program.n, 2);
  EXPECT_FALSE(read.runs[15].options.program.buffer_saves);
  EXPECT_EQ(read.runs[15].options.timing, model::TimingStyle::approximately_timed);
  EXPECT_EQ(read.runs[16].name, "full n1 both lt");
}

TEST_F(Golden, GridsThatAreNoneAreRefusedByName) {
  EXPECT_NE(refusal("width = ").find("grid.toml:1: cannot be read as TOML"), std::string::npos);
  EXPECT_NE(refusal("height = 4\nwidth = ").find("grid.toml:2: cannot"), std::string::npos);
  EXPECT_EQ(refusal("height = 4\nwidth = 0.5\nsamples = 1\n" + kOneRun),
            "grid.toml:2: width: found '0.5', allowed is an integer from 1 to 10000");
  EXPECT_EQ(refusal("height = 4\nsamples = 1\n" + kOneRun),
            "grid.toml: width: found none, allowed is an integer from 1 to 10000");
  EXPECT_EQ(refusal(kHead), "grid.toml: grid: found none, allowed is one [[grid]] or more");
  EXPECT_EQ(refusal("colour = 1\n" + kHead + kOneRun)
                .rfind("grid.toml:1: colour: found an unknown key, allowed is width, ", 0),
            0u);
  EXPECT_EQ(refusal(kHead + "[[grid]]\nchip = [\"csx600\"]\n"),
            "grid.toml:4: scene: found none, allowed is a list of scenes");
  const auto of_key = [&](const std::string& key) { return refusal(kHead + product(key + "\n")); };
  EXPECT_EQ(of_key("firmware.program = [\"fast\"]"),
            "grid.toml:6: firmware.program: found 'fast'; allowed: one of segments, direct, full");
  EXPECT_EQ(of_key("chip = [\"csx6\"]").rfind("grid.toml:6: unknown preset 'csx6'; allowed: ", 0), 0u);
  EXPECT_EQ(of_key("firmware.n = [0, 9]"),
            "grid.toml:6: firmware.n: found '9'; allowed: an integer from 0 to 8");
  EXPECT_EQ(of_key("firmware.n = 1"), "grid.toml:6: firmware.n: found '1', allowed is a list of values");
  EXPECT_EQ(of_key("firmware.n = []"),
            "grid.toml:6: firmware.n: found an empty list, allowed is a list of values");
  EXPECT_EQ(of_key("firmware.n = [[1]]"),
            "grid.toml:6: firmware.n: found an array in a list, allowed is values");
  EXPECT_EQ(of_key("firmware.node_width = [3]"),
            "grid.toml:6: firmware.node_width: found '3'; allowed: one of 2, 4, 8");
  EXPECT_EQ(of_key("firmware.node_format = [\"fp16\"]"),
            "grid.toml:6: firmware.node_format: found 'fp16'; allowed: one of fp64, fp32, quantised8");
  EXPECT_EQ(of_key("firmware.traversal = [\"magic\"]")
                .rfind("grid.toml:6: firmware.traversal: found 'magic'; allowed: one of brute_force, ", 0),
            0u);
  EXPECT_EQ(of_key("samples = [2]"),
            "grid.toml:6: samples: found it in a [[grid]], allowed is width, height and samples of the whole "
            "file, above");
  EXPECT_EQ(of_key("firmware.depth = [2]").rfind("grid.toml:6: found the key 'firmware.depth'", 0), 0u);
}

TEST_F(Golden, ChipFilesAreRelativeToTheGrid) {
  std::filesystem::create_directories(directory_ / "chips/other");
  write("chips/slow.toml", "preset = \"csx600\"\n[pio]\nsetup_cycles = 777\n");
  const GoldenGrid read = grid(kHead + product("chip = [\"chips/slow.toml\"]\n"));
  ASSERT_EQ(read.runs.size(), 1u);
  EXPECT_EQ(read.runs[0].options.chip.pio.setup_cycles, 777);
  EXPECT_EQ(read.runs[0].file, "cornell_box-slow.csv");
  EXPECT_EQ(refusal(kHead + product("chip = [\"slow.toml\"]\n")).rfind("grid.toml:6: ", 0), 0u);
  write("chips/other/slow.toml", "preset = \"csx600\"\n");
  EXPECT_NE(refusal(kHead + product("chip = [\"chips/slow.toml\", \"chips/other/slow.toml\"]\n"))
                .find("allowed is files of different names"),
            std::string::npos)
      << "the second one would take the place of the first";
}

TEST_F(Golden, ProductsThatNoMachineCanRunAreRefusedBeforeTheyAreMade) {
  const std::string numbers = "[1, 2, 3, 4, 5, 6, 7, 8, 9, 10]\n";
  std::string lists;
  for (const char* const key :
       {"pio.setup_cycles", "pio.per_pe_cycles", "host.latency_cycles", "ddr.ecc_cycles"})
    lists += key + (" = " + numbers);
  EXPECT_EQ(grid(kHead + product(lists)).runs.size(), 10000u);
  EXPECT_EQ(
      refusal(kHead + product(lists + "ddr.refresh_cycles = " + numbers)),
      "grid.toml:10: ddr.refresh_cycles: found 100000 combinations with the lists above, allowed is at most "
      "10000");
  EXPECT_EQ(refusal(kHead + product(lists) + kOneRun),
            "grid.toml:11: scene: found 10001 combinations with the lists above, allowed is at most 10000");
}

TEST_F(Golden, NamesOfEarlierGridsAreRefusedWithTheNewOnes) {
  for (const auto& [old, now] : {std::pair("scenes = [\"a\"]", "scene"),
                                 {"chips = [\"csx600\"]", "chip"},
                                 {"programs = [\"full\"]", "firmware.program"},
                                 {"n = [1]", "firmware.n"},
                                 {"buffers = [\"both\"]", "firmware.buffer"},
                                 {"timings = [\"lt\"]", "timing"},
                                 {"traversals = [\"refill\"]", "firmware.traversal"},
                                 {"node_formats = [\"fp32\"]", "firmware.node_format"},
                                 {"node_widths = [4]", "firmware.node_width"}}) {
    const std::string key = std::string(old).substr(0, std::string(old).find(' '));
    EXPECT_EQ(refusal(kHead + product(std::string(old) + "\n")),
              "grid.toml:6: " + key + ": found a name that is no longer used, allowed is " + now);
  }
}

/// Every option of the firmware and every parameter of the chip can be a key; the run's name says which.
TEST_F(Golden, KeysAreThoseOfSweeps) {
  const GoldenGrid read = grid(kHead + product("firmware.visits = [2, 3]\nfirmware.traversal = [\"refill\"]\n"
                                               "pio.setup_cycles = [99]\n"));
  ASSERT_EQ(read.runs.size(), 2u);
  EXPECT_EQ(read.runs[1].name, "full n1 both lt refill fp32 4 firmware.visits=3 pio.setup_cycles=99");
  EXPECT_EQ(read.runs[1].file, "cornell_box-csx600.csv");
  EXPECT_EQ(read.runs[1].options.chip.pio.setup_cycles, 99);
  EXPECT_EQ(read.runs[1].options.program.tree.visits, 3);
  EXPECT_EQ(read.runs[1].given.count("visits"), 1u) << "it is not chosen again";
}

TEST_F(Golden, TreesHaveATraversalAFormatAndAWidth) {
  const GoldenGrid read =
      grid(kHead + product("chip = [\"csx600\"]\nfirmware.program = [\"segments\"]\nfirmware.n = [1]\n"
                           "firmware.buffer = [\"both\"]\ntiming = [\"lt\"]\n"
                           "firmware.traversal = [\"brute_force\", \"refill\"]\n"
                           "firmware.node_format = [\"fp64\"]\nfirmware.node_width = [2, 8]\n"));
  ASSERT_EQ(read.runs.size(), 3u);
  EXPECT_EQ(read.runs[0].name, "segments n1 both lt");
  EXPECT_EQ(read.runs[1].name, "segments n1 both lt refill fp64 2");
  EXPECT_EQ(read.runs[2].name, "segments n1 both lt refill fp64 8");
  const GoldenTables found = run(read, 1);
  const auto value = [&](std::size_t run, const std::string& key) -> std::string {
    for (const auto& [name, counter] : found.at("cornell_box-csx600.csv")[run].second)
      if (name == key) return counter.dump();
    return "";
  };
  EXPECT_EQ(value(0, "image_sha256"), value(1, "image_sha256"));
  EXPECT_EQ(value(0, "image_sha256"), value(2, "image_sha256"));
  EXPECT_NE(value(1, "simulated_cycles"), value(2, "simulated_cycles"));
}

std::string moves_of(const GoldenTables& kept, const GoldenTables& found) {
  return testbench::golden_moves(testbench::golden_verdicts(kept, found));
}

TEST_F(Golden, TablesComeBackAsTheyWereWrittenAndOldOnesGo) {
  const GoldenTables found = run(grid(kHead + kTwoChips), 2);
  ASSERT_EQ(found.size(), 2u);
  ASSERT_EQ(found.at("cornell_box-paper.csv").size(), 8u);
  write("cornell_box-gone.csv", "key,a\n");
  testbench::write_golden(directory_, found);
  EXPECT_EQ(moves_of(testbench::read_golden(directory_), found), "");
  EXPECT_FALSE(std::filesystem::exists(directory_ / "cornell_box-gone.csv"));
  EXPECT_EQ(read("cornell_box-csx600.csv").find("\nsimulator."), std::string::npos);
  EXPECT_NE(read("cornell_box-csx600.csv").find("\nchip.control_unit.cycles_by_cause.poly,"),
            std::string::npos);
  EXPECT_NE(read("cornell_box-csx600.csv").find("\nimage_sha256,"), std::string::npos);
}

TEST_F(Golden, WhatMovedIsNamedWithItsRunsAndDistance) {
  const GoldenTables kept = run(grid(kHead + kTwoChips), 2);
  const auto set = [](GoldenTables& tables, std::size_t run, const std::string& key, double factor) {
    for (auto& [name, value] : tables.at("cornell_box-paper.csv")[run].second)
      if (name == key) value = value.get<double>() * factor;
  };
  GoldenTables found = kept;
  set(found, 0, "chip.pio.busy_cycles", 2);
  set(found, 3, "chip.pio.busy_cycles", 0.75);
  const std::string moves = moves_of(kept, found);
  EXPECT_EQ(
      moves.rfind("  chip.pio.busy_cycles: in 2 of 16 runs  -25 to +50 %; cornell_box-paper segments n0 "
                  "loads lt: ",
                  0),
      0u)
      << moves;
  EXPECT_EQ(std::count(moves.begin(), moves.end(), '\n'), 1);
  found = kept;
  found.at("cornell_box-paper.csv").pop_back();
  EXPECT_EQ(moves_of(kept, found), "  run gone: cornell_box-paper full n2 loads at\n");
  EXPECT_EQ(moves_of(found, kept), "  new run: cornell_box-paper full n2 loads at\n");
}

TEST_F(Golden, VerdictsAreTestCasesAndJson) {
  const GoldenTables kept = run(grid(kHead + kOneRun), 1);
  GoldenTables found = kept;
  const std::string name = kept.begin()->second[0].first;
  for (auto& [key, value] : found.begin()->second[0].second)
    if (key == "chip.pio.busy_cycles") value = 1;
  found.begin()->second.push_back({"new <run>", kept.begin()->second[0].second});
  const auto verdicts = testbench::golden_verdicts(kept, found);
  const std::vector<testbench::TestCase> cases = testbench::golden_cases(verdicts);
  ASSERT_EQ(cases.size(), 2u);
  EXPECT_EQ(cases[0].group + ".csv", kept.begin()->first);
  EXPECT_EQ(cases[0].name, name);
  EXPECT_NE(cases[0].failure.find("1 counters moved"), std::string::npos) << cases[0].failure;
  const std::string xml = testbench::junit_xml("golden", cases);
  EXPECT_NE(xml.find("<testsuite name=\"golden\" tests=\"2\" failures=\"2\">"), std::string::npos) << xml;
  EXPECT_NE(xml.find("name=\"new &lt;run>\""), std::string::npos) << xml;
  const auto json = testbench::golden_json(verdicts);
  EXPECT_EQ(json[0]["moves"][0]["key"], "chip.pio.busy_cycles");
  EXPECT_EQ(json[0]["moves"][0]["b"], 1);
  EXPECT_EQ(json[1]["presence"], "only_found");
}

TEST_F(Golden, RunsEqualWhatAnotherParameterMoves) {
  const GoldenTables kept = run(grid(kHead + kOneRun), 1);
  EXPECT_EQ(moves_of(kept, run(grid(kHead + kOneRun), 1)), "");
  GoldenGrid slower = grid(kHead + kOneRun);
  slower.runs[0].options.chip.pio.setup_cycles += 1;
  const std::string moves = moves_of(kept, run(slower, 1));
  EXPECT_NE(moves.find("chip.pio.setup_cycles: in 1 of 1 runs"), std::string::npos) << moves;
  EXPECT_EQ(moves.find("image_sha256"), std::string::npos) << moves;
}

TEST_F(Golden, FilesThatAreNoTablesAreRefusedByName) {
  const auto refused = [&](const std::string& text) -> std::string {
    write("a.csv", text);
    try {
      testbench::read_golden(directory_);
      return "";
    } catch (const testbench::InputError& error) {
      return std::string(error.what()).substr(directory_.string().size() + 1);
    }
  };
  EXPECT_EQ(refused("key,one,two\na,1,2\nb,,3\n"), "");
  EXPECT_EQ(refused("").rfind("a.csv: not a table of golden runs", 0), 0u);
  EXPECT_EQ(refused("key,one,two\na,1,2\nb,3\n"), "a.csv:3: found 2 cells, allowed are 3");
  EXPECT_EQ(
      refused("key,one\nchip.host_link.host_dmas,1\n"),
      "a.csv:2: chip.host_link.host_dmas: found the key's old name, allowed is chip.host_link.transfers");
  EXPECT_EQ(refused("key,one,two\na,1,2\nb,,many\n"), "a.csv:3: b: found 'many'; allowed: a number");
  EXPECT_EQ(refused("key,one\na,[1]\n"), "a.csv:2: a: found '[1]'; allowed: a number");
  EXPECT_EQ(refused("key,one\nimage_sha256,12\n"),
            "a.csv:2: image_sha256: found '12'; allowed: 64 hexadecimal digits");
  EXPECT_EQ(refused("key,one\na,1\nb,2\na,3\n"), "a.csv:4: a: found a second row; allowed: one a counter");
}

}  // namespace golden_test
