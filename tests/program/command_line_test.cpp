// The program as users meet it: what it says, what it leaves and how it ends. Bad input:
// command_line_errors_test.cpp.

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "firmware/path_tracer/program/program_options.hpp"
#include "model/config/chip_parameters.hpp"
#include "tests/support/command_line.hpp"

namespace command_line_test {

using nlohmann::json;
using test_support::CommandResult;
using Files = std::vector<std::string>;

const std::string kCornellBox = std::string(CSX600_SCENES_DIR) + "/cornell_box";

class CommandLine : public test_support::CommandLineFixture {
 protected:
  /// Renders 8 x 6 pixels of the Cornell box.
  CommandResult render(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"render", kCornellBox, "--size", "8x6", "--samples", "2"});
    return run(arguments);
  }
  json statistics(const std::vector<std::string>& arguments) {
    std::vector<std::string> all = {"--stats", "statistics.json"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const CommandResult result = render(all);
    EXPECT_EQ(result.exit_code, 0) << result.error;
    return json::parse(read("statistics.json"));
  }
};

TEST_F(CommandLine, RenderWritesEveryOutputAndNothingElse) {
  const CommandResult result = render({"--exr", "a.exr", "--png", "a.png", "--stats", "a.json", "--waves",
                                       "a.vcd", "--waves-window", "100000:200000"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.error, "");
  for (const char* line : {"simulated time", "segments/s", "PE utilisation", "SIMD efficiency", "exposed PIO",
                           "DDR bandwidth", "simulator time", "faster than the silicon"})
    EXPECT_NE(result.out.find(line), std::string::npos) << line << " in " << result.out;
  std::set<std::string> names;
  for (const std::string& name : files()) {
    names.insert(name);
    EXPECT_EQ(name.rfind("a.", 0), 0u) << name;
    EXPECT_EQ(name.find("tmp"), std::string::npos) << name;
    EXPECT_EQ(name.find("partial"), std::string::npos) << name;
    EXPECT_FALSE(read(name).empty()) << name;
  }
  for (const char* name : {"a.exr", "a.png", "a.json", "a.vcd", "a.gtkw"})
    EXPECT_EQ(names.count(name), 1u) << name;
  EXPECT_EQ(read("a.exr").substr(0, 4), "\x76\x2f\x31\x01");
  EXPECT_EQ(read("a.png").substr(1, 3), "PNG");
}

TEST_F(CommandLine, StatisticsHaveWhatEveryReaderNeeds) {
  const json chip = statistics({});
  EXPECT_GT(chip.at("simulated_seconds").get<double>(), 0.0);
  EXPECT_GT(chip.at("simulated_cycles").get<std::uint64_t>(), 0u);
  EXPECT_GE(chip.at("segments").get<std::uint64_t>(), 96u);
  EXPECT_GT(chip.at("rays").get<std::uint64_t>(), chip.at("segments").get<std::uint64_t>());
  EXPECT_EQ(chip.at("image_sha256").get<std::string>().size(), 64u);
  EXPECT_GT(chip.at("simulator").at("cpu_seconds").get<double>(), 0.0);
  EXPECT_GT(chip.at("simulator").at("wall_seconds").get<double>(), 0.0);
  EXPECT_GT(chip.at("simulator").at("peak_bytes").get<std::uint64_t>(), 1000000u);
  const double clock_hz = chip.at("chip").at("clock_hz");
  EXPECT_DOUBLE_EQ(chip.at("simulated_seconds").get<double>(),
                   chip.at("simulated_cycles").get<double>() / clock_hz);
  std::uint64_t cycles = 0;
  for (const auto& [cause, of_cause] : chip.at("chip").at("control_unit").at("cycles_by_cause").items())
    cycles += of_cause.get<std::uint64_t>();
  EXPECT_EQ(cycles, chip.at("simulated_cycles").get<std::uint64_t>());
}

TEST_F(CommandLine, NativeRunHasTheSameImageAndNoTime) {
  const json chip = statistics({});
  const json native = statistics({"--native"});
  EXPECT_EQ(native.at("image_sha256"), chip.at("image_sha256"));
  EXPECT_EQ(native.at("segments"), chip.at("segments"));
  EXPECT_EQ(native.at("rays"), chip.at("rays"));
  EXPECT_TRUE(native.at("simulated_seconds").is_null());
  EXPECT_TRUE(native.at("simulated_cycles").is_null());
  EXPECT_EQ(native.count("chip"), 0u);
}

TEST_F(CommandLine, StatisticsOfTwoRunsDifferInTheSimulatorOnly) {
  json first = statistics({"--n", "2"});
  json second = statistics({"--n", "2"});
  EXPECT_EQ(first.erase("simulator"), 1u);
  second.erase("simulator");
  EXPECT_EQ(first.dump(), second.dump());
}

TEST_F(CommandLine, CheckingHazardsChangesOnlyTheSimulatorsTime) {
  json plain = statistics({"--n", "3"});
  json checked = statistics({"--n", "3", "--check-hazards"});
  plain.erase("simulator"), checked.erase("simulator");
  EXPECT_EQ(checked, plain);
  EXPECT_EQ(statistics({"--native", "--check-hazards"})["image_sha256"], plain["image_sha256"]);
}

TEST_F(CommandLine, OptionsReachTheFirmwareAndTheChip) {
  const json plain = statistics({});
  const json other = statistics({"--n", "3", "--buffer", "loads", "--program", "segments", "--seed", "7",
                                 "--bin-blocks", "4", "--slot-vertices", "8", "--roulette-start", "2",
                                 "--chip", "csx600_250mhz", "--set", "pio.setup_cycles=777"});
  const json expected = {
      {"program", "segments"}, {"n", 3},    {"buffer", "loads"}, {"bin_blocks", 4}, {"slot_vertices", 8},
      {"roulette_start", 2},   {"seed", 7}, {"samples", 2}};
  for (const auto& [key, value] : expected.items()) {
    EXPECT_EQ(other.at("firmware").at(key), value) << key;
    if (key != "samples") {
      EXPECT_NE(plain.at("firmware").at(key), value) << key;
    }
  }
  EXPECT_EQ(other.at("chip_preset"), "csx600_250mhz");
  EXPECT_EQ(other.at("chip").at("clock_hz").get<double>(), 250e6);
  EXPECT_EQ(other.at("chip_config").at("pio").at("setup_cycles"), 777);
  EXPECT_NE(other.at("image_sha256"), plain.at("image_sha256"));
}

/// One table declares them: each has its help, its place in the statistics and its record of what was given.
TEST_F(CommandLine, EveryFirmwareOptionReachesTheStatistics) {
  const std::string help = run({"render", "--help"}).out;
  const json plain = statistics({});
  EXPECT_EQ(plain.at("firmware").size(), path_tracer::program_options().size() + 1) << "and the samples";
  for (const path_tracer::ProgramOption& option : path_tracer::program_options()) {
    std::string name = "--" + option.name;
    std::replace(name.begin(), name.end(), '_', '-');
    EXPECT_NE(help.find("\n  " + name + " "), std::string::npos) << name;
    ASSERT_EQ(plain.at("firmware").count(option.name), 1u) << option.name;
  }
  const std::vector<std::vector<std::string>> given = {{"shadow_rays", "all"},
                                                       {"max_survival", "0.5"},
                                                       {"seed", "18446744073709551615"},
                                                       {"sampler", "philox"}};
  for (const auto& pair : given) {
    std::string name = "--" + pair[0];
    std::replace(name.begin(), name.end(), '_', '-');
    const json recorded = statistics({name, pair[1]}).at("firmware").at(pair[0]);
    EXPECT_EQ(recorded.is_string() ? recorded.get<std::string>() : recorded.dump(), pair[1]);
  }
}

TEST_F(CommandLine, OutputReplacesAnOlderFile) {
  write("old.png", "old");
  EXPECT_EQ(render({"--native", "--png", "old.png"}).exit_code, 0);
  EXPECT_EQ(read("old.png").substr(1, 3), "PNG");
  EXPECT_EQ(files(), Files{"old.png"});
}

TEST_F(CommandLine, SceneBesideItsMeshRenders) {
  const test_support::SceneFiles scene;
  write("scene/scene.toml", scene.toml);
  write("scene/mesh.obj", scene.obj);
  write("scene/mesh.mtl", scene.mtl);
  for (const char* path : {"scene", "scene/scene.toml"}) {
    const CommandResult result = run({"render", path, "--samples", "1"});
    EXPECT_EQ(result.exit_code, 0) << result.error;
    EXPECT_NE(result.out.find("8 x 6"), std::string::npos) << result.out;
  }
}

TEST_F(CommandLine, TrianglesWithoutAreaAreLeftOutWithANote) {
  const test_support::SceneFiles scene;
  write("scene.toml", scene.toml);
  write("mesh.obj", scene.obj + "f 1 1 2\n");
  write("mesh.mtl", scene.mtl);
  const CommandResult result = run({"render", "scene.toml", "--samples", "1", "--native"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.error, "csx600: note: scene.toml: a triangle without area is left out\n");
}

TEST_F(CommandLine, AMeshFileAloneIsOneCommandFromAPicture) {
  write("tile.OBJ", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  const CommandResult result =
      run({"render", "tile.OBJ", "--samples", "1", "--size", "8x8", "--native", "--png", "tile.png"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(
      result.error,
      "csx600: note: tile.OBJ:5: no material: a face has the default material of reflectance 0.8 (material "
      "of "
      "[[mesh]] sets another)\n"
      "csx600: note: tile.OBJ: no camera, so one that sees the whole mesh is used\n"
      "csx600: note: tile.OBJ: no triangle emits, so a square light above and behind the camera is added\n");
}

TEST_F(CommandLine, AMissingMtlFileIsANoteAndTheDefaultMaterial) {
  const test_support::SceneFiles scene;
  write("scene.toml", scene.toml);
  write("mesh.obj", scene.obj);
  const CommandResult result = run({"render", "scene.toml", "--samples", "1", "--native"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_NE(result.error.find("csx600: note: mesh.obj:1: mesh.mtl: an MTL file is missing\n"),
            std::string::npos)
      << result.error;
  EXPECT_NE(result.error.find("no material 'light': a face has the default material"), std::string::npos)
      << result.error;
}

TEST_F(CommandLine, FilesOutsideTheSceneNeedAllowOutside) {
  const test_support::SceneFiles scene;
  std::string toml = scene.toml;
  toml.replace(toml.find("mesh.obj"), 8, "../mesh.obj");
  write("in/scene.toml", toml);
  write("mesh.obj", scene.obj);
  write("mesh.mtl", scene.mtl);
  const std::vector<std::string> command = {"render", "in", "--samples", "1", "--native"};
  const CommandResult refused = run(command);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.error.find("--allow-outside"), std::string::npos) << refused.error;
  std::vector<std::string> allowed = command;
  allowed.push_back("--allow-outside");
  EXPECT_EQ(run(allowed).exit_code, 0);
}

/// Waits until Linux says that the process catches SIGINT, then a little longer, into the run.
void wait_until_interrupts_are_caught(pid_t child) {
  constexpr unsigned long kInterrupt = 1ul << (SIGINT - 1);
  unsigned long caught = 0;
  for (int attempt = 0; (caught & kInterrupt) == 0; ++attempt) {
    ASSERT_LT(attempt, 2000) << "it has ended";
    std::ifstream status("/proc/" + std::to_string(child) + "/status");
    for (std::string line; std::getline(status, line);)
      if (line.rfind("SigCgt:", 0) == 0) caught = std::stoul(line.substr(7), nullptr, 16);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
}

TEST_F(CommandLine, AnInterruptLeavesWhatIsDoneMarkedPartial) {
  for (const std::vector<std::string>& how :
       {Files{}, Files{"--native"}, Files{"--paths", "bidirectional"}}) {
    Files arguments = {"render",  kCornellBox, "--size", "32x32",   "--samples",
                       "1000000", "--exr",     "a.exr",  "--stats", "a.json"};
    arguments.insert(arguments.end(), how.begin(), how.end());
    const pid_t child = start(arguments);
    wait_until_interrupts_are_caught(child);
    ASSERT_EQ(kill(child, SIGTERM), 0);
    const CommandResult result = finish(child);
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_EQ(result.error.rfind("csx600: interrupted after ", 0), 0u) << result.error;
    EXPECT_NE(result.error.find(" of 1024000000 paths; what was written is marked partial\n"),
              std::string::npos);
    EXPECT_EQ(files(), (Files{"a.exr", "a.json"}));
    EXPECT_NE(read("a.exr").find("csx600.partial"), std::string::npos);
    const json statistics = json::parse(read("a.json"));
    EXPECT_EQ(statistics["partial"], true);
    const auto paths = statistics["counts"]["paths"].get<double>();
    EXPECT_GT(paths, 0);
    EXPECT_EQ(statistics["samples_a_pixel"]["mean"].get<double>() * 1024, paths)
        << "each path that began is whole";
  }
}

TEST_F(CommandLine, ParamsListsEveryParameterAndOption) {
  const CommandResult result = run({"params", "--json", "params.json"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.error, "");
  const json list = json::parse(read("params.json"));
  std::set<std::string> in_json;
  for (const json& parameter : list) {
    const bool is_option = parameter.at("key").get<std::string>().rfind("firmware.", 0) == 0;
    for (const char* member : {"unit", "meaning", "default", "allowed"})
      EXPECT_EQ(parameter.count(member), 1u) << parameter;
    for (const char* member : {"value", "confidence"})
      EXPECT_EQ(parameter.count(member), is_option ? 0u : 1u);
    EXPECT_EQ(parameter.count("group"), is_option ? 1u : 0u) << parameter;
    in_json.insert(parameter.at("key").get<std::string>());
  }
  EXPECT_GE(in_json.size(), 40u);
  EXPECT_EQ(in_json.size(), model::parameter_table().size() + path_tracer::program_options().size());
  const std::string markdown = run({"params", "--markdown"}).out;
  for (const path_tracer::ProgramOption& option : path_tracer::program_options()) {
    EXPECT_EQ(in_json.count("firmware." + option.name), 1u) << option.name;
    EXPECT_NE(result.out.find("\nfirmware." + option.name + " "), std::string::npos) << option.name;
    EXPECT_NE(markdown.find("\n| `firmware." + option.name + "` | "), std::string::npos) << option.name;
  }
  for (const model::ParameterInfo& parameter : model::parameter_table()) {
    EXPECT_EQ(in_json.count(std::string(parameter.key)), 1u) << parameter.key;
    EXPECT_NE(result.out.find(std::string(parameter.key)), std::string::npos) << parameter.key;
    EXPECT_NE(markdown.find("\n| `" + parameter.key + "` | "), std::string::npos) << parameter.key;
  }
}

TEST_F(CommandLine, ParamsShowWhatWasSet) {
  const CommandResult result = run({"params", "--set", "pio.setup_cycles=4321", "--json", "params.json"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_NE(result.out.find("4321"), std::string::npos);
  EXPECT_NE(read("params.json").find("4321"), std::string::npos);
}

TEST_F(CommandLine, ReproduceComparesEveryCell) {
  const test_support::SceneFiles scene;
  write("scene.toml", scene.toml);
  write("mesh.obj", scene.obj);
  write("mesh.mtl", scene.mtl);
  const CommandResult result = run({"reproduce", "scene.toml", "--samples", "1", "--json", "tables.json"});
  EXPECT_EQ(result.exit_code, 0) << result.error;
  EXPECT_EQ(result.error, "");
  const json tables = json::parse(read("tables.json"));
  ASSERT_EQ(tables.at("cells").size(), 24u);
  for (const json& cell : tables.at("cells")) {
    EXPECT_GT(cell.at("model_seconds").get<double>(), 0.0);
    EXPECT_GT(cell.at("paper_seconds").get<double>(), 5.0);
  }
  for (const char* part : {"Table 1", "Table 2", "n = 3", "loads", "7.63", "13.28"})
    EXPECT_NE(result.out.find(part), std::string::npos) << part;
}

TEST_F(CommandLine, HelpIsNotAnError) {
  for (const Files& arguments : {Files{"--help"}, Files{"render", "--help"}}) {
    const CommandResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(result.error, "");
    EXPECT_NE(result.out.find("render"), std::string::npos);
  }
}

}  // namespace command_line_test
