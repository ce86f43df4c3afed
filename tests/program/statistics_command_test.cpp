// `csx600 stats`, `compare` and `golden` as their users meet them.

#include <sys/stat.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/command_line.hpp"

namespace statistics_command_test {

using nlohmann::ordered_json;
using test_support::CommandResult;

const std::string kCornellBox = std::string(CSX600_SCENES_DIR) + "/cornell_box";

class StatisticsCommands : public test_support::CommandLineFixture {
 protected:
  CommandResult render(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"render", kCornellBox, "--size", "8x6", "--samples", "2"});
    const CommandResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.error;
    return result;
  }
  void expect_error(const std::vector<std::string>& arguments, int exit_code, const std::string& line) {
    const CommandResult result = run(arguments);
    EXPECT_EQ(result.exit_code, exit_code);
    ASSERT_EQ(result.error_lines().size(), 1u) << result.error;
    EXPECT_EQ(result.error_lines()[0], "csx600: " + line);
  }
};

TEST_F(StatisticsCommands, FormFollowsTheSuffix) {
  render({"--stats", "a.json"});
  render({"--stats", "a.csv"});
  render({"--stats", "a.txt"});
  EXPECT_NE(read("a.json").find("\"format\": \"csx600-statistics-2\""), std::string::npos);
  EXPECT_EQ(read("a.csv").rfind("key,unit,value,meaning\n", 0), 0u);
  EXPECT_NE(read("a.csv").find("\nchip.energy.watts,W,"), std::string::npos);
  EXPECT_NE(read("a.txt").find("\nchip.energy\n  joules "), std::string::npos);
}

TEST_F(StatisticsCommands, StatsPrintsAndConvertsWhatRenderHasWritten) {
  const std::string text = render({"--stats", "a.json", "--stats-text"}).out;
  const CommandResult shown = run({"stats", "a.json"});
  EXPECT_EQ(shown.exit_code, 0) << shown.error;
  for (const char* part : {"\nchip.pio\n", "  busy_cycles ", "\nchip.roofline\n", "  rays_per_joule "}) {
    EXPECT_NE(shown.out.find(part), std::string::npos) << part;
    EXPECT_NE(text.find(part), std::string::npos) << part;
  }
  EXPECT_EQ(run({"stats", "a.json", "-o", "b.json"}).exit_code, 0);
  EXPECT_EQ(read("b.json"), read("a.json"));
  EXPECT_EQ(run({"stats", "a.json", "-o", "b.csv"}).exit_code, 0);
  EXPECT_EQ(read("b.csv").rfind("key,unit,value,meaning\n", 0), 0u);
}

TEST_F(StatisticsCommands, ComparisonsAreWrittenForMachines) {
  render({"--stats", "a.json"});
  ordered_json other = ordered_json::parse(read("a.json"));
  other["chip"]["pio"]["busy_cycles"] = 1;
  write("b.json", other.dump());
  const CommandResult result =
      run({"compare", "a.json", "b.json", "--junit", "junit.xml", "--json", "moves.json"});
  EXPECT_EQ(result.exit_code, 1);
  const ordered_json moves = ordered_json::parse(read("moves.json"));
  ASSERT_EQ(moves["differences"].size(), 1u);
  EXPECT_EQ(moves["differences"][0]["key"], "chip.pio.busy_cycles");
  EXPECT_EQ(moves["differences"][0]["b"], 1);
  EXPECT_EQ(moves["differences"][0]["unit"], "cycles");
  const std::string xml = read("junit.xml");
  EXPECT_NE(xml.find("tests=\"" + std::to_string(moves["compared"].get<int>()) + "\" failures=\"1\""),
            std::string::npos)
      << xml.substr(0, 300);
  EXPECT_NE(xml.find("<testcase classname=\"chip.pio\" name=\"busy_cycles\">\n    <failure message="),
            std::string::npos);
  EXPECT_EQ(run({"compare", "a.json", "b.json", "--junit", "a.json"}).exit_code, 2);
}

TEST_F(StatisticsCommands, NativeStatisticsAreStatisticsToo) {
  render({"--native", "--stats", "a.json"});
  EXPECT_EQ(run({"stats", "a.json"}).exit_code, 0);
  EXPECT_EQ(run({"compare", "a.json", "a.json"}).exit_code, 0);
}

TEST_F(StatisticsCommands, DescribePrintsNameUnitMeaning) {
  const CommandResult result = run({"stats", "--describe"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_NE(result.out.find("chip.ddr.page_misses"), std::string::npos);
  EXPECT_NE(result.out.find("bytes      loaded, in all PEs"), std::string::npos);
  expect_error({"stats"}, 2, "stats: found neither, allowed is either a statistics file or --describe");
  render({"--stats", "a.json"});
  expect_error({"stats", "a.json", "--describe"}, 2,
               "stats: found a file and --describe, allowed is either a statistics file or --describe");
}

TEST_F(StatisticsCommands, EqualRunsCompareEqualWhateverTheSimulatorsTimes) {
  render({"--stats", "a.json"});
  render({"--stats", "b.json"});
  EXPECT_NE(read("a.json"), read("b.json"));
  const CommandResult result = run({"compare", "a.json", "b.json"});
  EXPECT_EQ(result.exit_code, 0) << result.error;
  EXPECT_EQ(result.out.rfind("equal: ", 0), 0u) << result.out;
  EXPECT_EQ(run({"compare", "a.json", "b.json", "--simulator"}).exit_code, 1);
}

TEST_F(StatisticsCommands, OldNamesAreRefusedWithTheirNewOnes) {
  render({"--stats", "a.json"});
  std::string text = read("a.json");
  const std::string current = "\"transfers\"";
  ASSERT_NE(text.find(current), std::string::npos);
  text.replace(text.find(current), current.size(), "\"host_dmas\"");
  std::ofstream(directory() / "old.json") << text;
  const std::string found =
      "chip.host_link.host_dmas: found the key's old name, allowed is chip.host_link.transfers";
  expect_error({"stats", "old.json"}, 2, "old.json: " + found);
  expect_error({"compare", "a.json", "old.json"}, 2, "old.json: " + found);
  expect_error({"report", "old.json"}, 2, "old.json: " + found);
  expect_error({"compare", "a.json", "a.json", "--ignore", "chip.host_link.host_dmas"}, 2,
               "--ignore: " + found);
  expect_error({"compare", "a.json", "a.json", "--tolerance", "chip.host_link.host_dmas=1"}, 2,
               "--tolerance: " + found);
}

TEST_F(StatisticsCommands, AnotherChipIsADifferenceThatIsShown) {
  render({"--stats", "a.json"});
  render({"--stats", "b.json", "--set", "pio.setup_cycles=300"});
  const CommandResult result = run({"compare", "a.json", "b.json"});
  EXPECT_EQ(result.exit_code, 1);
  ASSERT_EQ(result.error_lines().size(), 1u);
  EXPECT_EQ(result.error.rfind("csx600: a.json and b.json differ in ", 0), 0u) << result.error;
  for (const char* part : {"chip_config.pio\n", "  setup_cycles ", " +50 %", "chip.pio\n", " cycles\n"})
    EXPECT_NE(result.out.find(part), std::string::npos) << part << " in " << result.out;
  EXPECT_EQ(result.out.find("image_sha256"), std::string::npos);
  EXPECT_EQ(run({"compare", "a.json", "b.json", "--ignore", "chip_config.*", "--ignore", "simulated*",
                 "--tolerance", "chip.*=2", "--tolerance", "*per_joule=1", "--ignore", "*nearest_roof",
                 "--ignore", "*critical"})
                .exit_code,
            0);  // the verdict's sentence is no difference
  EXPECT_EQ(run({"compare", "a.json", "b.json", "--tolerance", "chip*=2", "--tolerance",
                 "chip.pio.setup_cycles=0.1", "--ignore", "*per_joule", "--ignore", "simulated*"})
                .exit_code,
            1);
}

TEST_F(StatisticsCommands, AScenesPathMayBeSpelledInAnyWay) {
  render({"--stats", "a.json"});
  for (const std::string& spelling : {kCornellBox + "/", kCornellBox + "/scene.toml", kCornellBox + "/."}) {
    ASSERT_EQ(run({"render", spelling, "--size", "8x6", "--samples", "2", "--stats", "b.json"}).exit_code, 0);
    EXPECT_EQ(run({"compare", "a.json", "b.json"}).exit_code, 0) << spelling;
  }
  ordered_json other = ordered_json::parse(read("a.json"));
  other["scene"] = "models/another_box";
  write("b.json", other.dump());
  EXPECT_EQ(run({"compare", "a.json", "b.json"}).exit_code, 1);
}

TEST_F(StatisticsCommands, CountsOf64BitsAreComparedExactly) {
  render({"--stats", "a.json"});
  ordered_json json = ordered_json::parse(read("a.json"));
  json["counts"]["segments"] = (std::uint64_t{1} << 60) + 1;
  write("b.json", json.dump());
  json["counts"]["segments"] = (std::uint64_t{1} << 60) + 4;
  write("c.json", json.dump());
  EXPECT_EQ(run({"compare", "b.json", "c.json"}).exit_code, 1);
  EXPECT_EQ(run({"compare", "b.json", "c.json", "--absolute", "counts.*=2"}).exit_code, 1);
  EXPECT_EQ(run({"compare", "b.json", "c.json", "--absolute", "counts.*=3"}).exit_code, 0);
  EXPECT_EQ(run({"compare", "b.json", "c.json", "--absolute", "chip.*=3"}).exit_code, 1);
  expect_error(
      {"compare", "b.json", "c.json", "--absolute", "counts.*=-1"}, 2,
      "--absolute: found 'counts.*=-1', allowed is KEYGLOB=DISTANCE, for example chip.ddr.page_hits=10");
  expect_error({"compare", "b.json", "c.json", "--ignore", "*"}, 2,
               "--ignore: found that it leaves no value to compare, allowed are keys that leave one");
}

TEST_F(StatisticsCommands, NestedFilesAndPipesAreRefusedByEveryReader) {
  render({"--stats", "a.json"});
  std::string text = read("a.json");
  const std::string deep(200'000, '[');
  write("deep.json", text.substr(0, text.rfind('}')) + ",\"x\":" + deep + std::string(200'000, ']') + "}");
  std::string parts = "a";
  for (int i = 0; i < 100'000; ++i) parts += ".a";
  write("deep.toml", parts + " = 1\n");
  ASSERT_EQ(mkfifo((directory() / "pipe.json").c_str(), 0600), 0);
  ASSERT_EQ(mkfifo((directory() / "pipe.toml").c_str(), 0600), 0);
  for (const std::string& name : {std::string("deep"), std::string("pipe")})
    for (const std::vector<std::string>& command : {std::vector<std::string>{"stats", name + ".json"},
                                                    {"report", name + ".json"},
                                                    {"compare", "a.json", name + ".json"},
                                                    {"params", "--chip", name + ".toml"},
                                                    {"sweep", name + ".toml"},
                                                    {"render", kCornellBox, "--chip", name + ".toml"}}) {
      const CommandResult result = run(command);
      EXPECT_EQ(result.exit_code, 2) << command[0] << ' ' << name;
      ASSERT_EQ(result.error_lines().size(), 1u) << result.error;
      EXPECT_NE(result.error.find(name == "deep" ? "more than 64 deep" : "a device, pipe or socket"),
                std::string::npos)
          << result.error;
    }
}

TEST_F(StatisticsCommands, ValuesOfAnotherTypeAreRefusedWithLineAndKey) {
  render({"--stats", "a.json"});
  std::string text = read("a.json");
  const std::size_t at = text.find("\"runs\": ");
  ASSERT_NE(at, std::string::npos);
  const auto line = 1 + std::count(text.begin(), text.begin() + std::ptrdiff_t(at), '\n');
  text.replace(at, 8, "\"runs\": [], \"x\": ");
  write("wrong.json", text);
  const std::string message = "wrong.json:" + std::to_string(line) +
                              ": chip.pe_array.kernels.0.runs: found a list; allowed: a number or null";
  for (const std::vector<std::string>& command : {std::vector<std::string>{"stats", "wrong.json"},
                                                  {"report", "wrong.json"},
                                                  {"compare", "a.json", "wrong.json"}})
    expect_error(command, 2, message);
}

TEST_F(StatisticsCommands, WrongUsageAndFilesEndWithTwo) {
  render({"--stats", "a.json"});
  expect_error(
      {"compare", "a.json", "none.json"}, 2,
      "none.json: found that it cannot be read (No such file or directory); allowed: a statistics file");
  expect_error({"compare", ".", "a.json"}, 2,
               ".: found that it cannot be read (Is a directory); allowed: a statistics file");
  write("half.json", "{\n\"format\": \"csx600-statistics-2\",\n\"scene");
  const std::string half = "half.json:3: found no JSON object that is whole; allowed: a statistics file";
  expect_error({"compare", "half.json", "a.json"}, 2, half);
  expect_error({"stats", "half.json"}, 2, half);
  write("empty.json", "");
  expect_error({"stats", "empty.json"}, 2, "empty.json: found an empty file; allowed: a statistics file");
  expect_error({"compare", "a.json", "empty.json"}, 2,
               "empty.json: found an empty file; allowed: a statistics file");
  ordered_json other = ordered_json::parse(read("a.json"));
  other["format"] = "csx600-statistics-0";
  write("old.json", other.dump());
  expect_error(
      {"compare", "a.json", "old.json"}, 2,
      "old.json: format: found 'csx600-statistics-0', allowed is 'csx600-statistics-2' or 'csx600-run-1'");
  other["format"] = "csx600-statistics-1";
  write("old.json", other.dump());
  for (const std::vector<std::string>& command : {std::vector<std::string>{"stats", "old.json"},
                                                  {"compare", "a.json", "old.json"},
                                                  {"report", "old.json"}})
    expect_error(command, 2,
                 "old.json: format: found 'csx600-statistics-1', allowed is 'csx600-statistics-2' or "
                 "'csx600-run-1'; an older "
                 "csx600 wrote it, with other keys: run the render again");
  for (const char* tolerance :
       {"chip.*", "chip.*=", "=0.1", "chip.*=x", "chip.*=-1", "chip.*=nan", "chip.*=1y"})
    expect_error({"compare", "a.json", "a.json", "--tolerance", tolerance}, 2,
                 "--tolerance: found '" + std::string(tolerance) +
                     "', allowed is KEYGLOB=REL, for example chip.ddr.*=0.01");
  EXPECT_EQ(run({"compare", "a.json"}).exit_code, 2);
}

TEST_F(StatisticsCommands, GoldenUpdatesWithOneCommandAndShowsWhatMoved) {
  const auto grid = [](int samples) {
    return "width = 6\nheight = 4\nsamples = " + std::to_string(samples) + "\n[[grid]]\nscene = [\"" +
           kCornellBox + "\"]\nchip = [\"csx600\"]\nfirmware.program = [\"full\"]\ntiming = [\"lt\"]\n";
  };
  write("kept/grid.toml", grid(1));
  EXPECT_EQ(run({"golden", "kept"}).exit_code, 1) << "no table is kept yet";
  const CommandResult first = run({"golden", "kept", "--update"});
  EXPECT_EQ(first.exit_code, 0) << first.error;
  EXPECT_NE(first.out.find("new run: cornell_box-csx600 full n1 both lt"), std::string::npos);
  EXPECT_EQ(run({"golden", "kept"}).out, "1 runs, no counter moved\n");
  write("kept/grid.toml", grid(2));
  const CommandResult moved = run({"golden", "kept"});
  EXPECT_EQ(moved.exit_code, 1);
  EXPECT_NE(
      moved.out.find(
          "  counts.paths: in 1 of 1 runs  +50 to +50 %; cornell_box-csx600 full n1 both lt: 24 -> 48\n"),
      std::string::npos)
      << moved.out;
  EXPECT_EQ(run({"golden", "kept", "--update"}).exit_code, 0);
  EXPECT_EQ(run({"golden", "kept"}).exit_code, 0);
  expect_error({"golden", "none"}, 2,
               "none/grid.toml: found that it cannot be read (No such file or directory); allowed: a grid of "
               "golden runs");
}

}  // namespace statistics_command_test
