// Bad input: exit code 2 (1 for a run that failed), one line that names what is wrong, and no file left
// behind.

#include <unistd.h>

#include <functional>
#include <regex>

#include "tests/support/command_line.hpp"

namespace command_line_errors_test {

using test_support::CommandResult;
using test_support::SceneFiles;
using Words = std::vector<std::string>;

const std::string kCornellBox = std::string(CSX600_SCENES_DIR) + "/cornell_box";

class CommandLineErrors : public test_support::CommandLineFixture {
 protected:
  /// The one line; it must have all `parts`.
  std::string expect_error(const Words& arguments, const Words& parts, int exit_code = 2) {
    std::string command;
    for (const std::string& word : arguments) command += word + " ";
    SCOPED_TRACE(command);
    const Words before = files();
    const CommandResult result = run(arguments);
    EXPECT_EQ(result.exit_code, exit_code);
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(files(), before) << "files left behind";
    const Words lines = result.error_lines();
    EXPECT_EQ(lines.size(), 1u) << result.error;
    if (lines.empty()) return "";
    EXPECT_EQ(lines[0].rfind("csx600: ", 0), 0u) << lines[0];
    for (const std::string& part : parts)
      EXPECT_NE(lines[0].find(part), std::string::npos) << part << " in: " << lines[0];
    return lines[0];
  }
  /// Expects the error from a render of the Cornell box that has every output option.
  void expect_render_error(const Words& arguments, const Words& parts, int exit_code = 2) {
    Words all = {"render", kCornellBox, "--exr", "a.exr", "--png", "a.png", "--stats", "a.json"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    expect_error(all, parts, exit_code);
  }
  void expect_scene_error(const SceneFiles& scene, const Words& parts) {
    write("scene/scene.toml", scene.toml);
    write("scene/mesh.obj", scene.obj);
    write("scene/mesh.mtl", scene.mtl);
    for (const Words& how : {Words{}, Words{"--native"}}) {
      Words arguments = {"render", "scene", "--exr", "a.exr", "--samples", "1"};
      arguments.insert(arguments.end(), how.begin(), how.end());
      expect_error(arguments, parts);
    }
  }
  static std::string replaced(const std::string& text, const std::string& from, const std::string& to) {
    EXPECT_NE(text.find(from), std::string::npos);
    return std::regex_replace(text, std::regex(from), to);
  }
};

TEST_F(CommandLineErrors, Usage) {
  expect_error({}, {"subcommand"});
  expect_error({"paint"}, {"--help"});
  expect_error({"render"}, {"scene is required"});
  expect_render_error({"--colour", "red"}, {"--colour"});
  expect_render_error({"--samples"}, {"--samples"});
  expect_render_error({"--samples", "0"}, {"--samples", "0", "1 to"});
  expect_render_error({"--samples", "many"}, {"--samples", "many"});
  expect_render_error({"--program", "quick"}, {"--program", "quick", "segments", "direct", "full"});
  expect_render_error({"--buffer", "all"}, {"--buffer", "all", "loads", "saves", "both", "none"});
  expect_render_error({"--level", "v9"}, {"--level", "v9", "v2"});
  expect_render_error({"--seed", "-1"}, {"--seed", "-1"});
  expect_render_error({"--node-format", "fp16"}, {"--node-format", "'fp16'", "fp64", "fp32", "quantised8"});
  expect_render_error({"--traversal", "magic"},
                      {"--traversal", "'magic'", "brute_force", "temporary_bin", "refill", "packets"});
  expect_render_error({"--traversal", "1"}, {"--traversal", "'1'", "refill"});
  expect_render_error({"--sampler", "halton"}, {"--sampler", "'halton'", "philox", "sobol"});
  expect_render_error({"--light-sampling", "none"}, {"--light-sampling", "'none'", "area", "solid_angle"});
  expect_error({"reproduce", kCornellBox, "--samples", "0"}, {"--samples"});
}

TEST_F(CommandLineErrors, Size) {
  for (const char* size : {"0x0", "0x5", "5x0", "-1x5", "5", "5x", "x5", "5x5x5", "axb", "16385x1",
                           "4294967297x1", "5 x 5", "99999999999999999999x1"})
    expect_render_error({"--size", size}, {"--size", std::string("'") + size + "'", "1 to 16384"});
}

TEST_F(CommandLineErrors, Firmware) {
  expect_render_error({"--n", "9"}, {"--n: found '9'", "0 to 8"});
  expect_render_error({"--n", "-1"}, {"--n: found '-1'", "0 to 8"});
  expect_render_error({"--n", "1.5"}, {"--n: found '1.5'", "an integer from 0 to 8"});
  expect_render_error({"--n", "4", "--bin-blocks", "3"}, {"n: found 4", "bin length", "3 blocks"});
  expect_render_error({"--bin-blocks", "0"}, {"--bin-blocks: found '0'", "1 to 65536"});
  expect_render_error({"--slot-vertices", "6"}, {"--slot-vertices: found '6'", "multiple of 4"});
  expect_render_error({"--roulette-start", "-3"}, {"--roulette-start: found '-3'", "from 0"});
}

TEST_F(CommandLineErrors, Tree) {
  const auto expect_tree_error = [&](Words arguments, const Words& parts) {
    arguments.insert(arguments.end(), {"--traversal", "refill"});
    expect_render_error(arguments, parts);
  };
  expect_tree_error({"--node-width", "3"}, {"--node-width: found '3'", "2, 4, 8"});
  expect_tree_error({"--node-width", "2", "--node-format", "quantised8"}, {"found 2", "4 or 8"});
  expect_tree_error({"--stack-entries", "3"}, {"--stack-entries: found '3'", "0, 1, 2, 4, 8, 16, 32"});
  expect_tree_error({"--visits", "-1"}, {"--visits: found '-1'", "0 to 1024"});
  expect_tree_error({"--leaf-triangles", "9"}, {"--leaf-triangles: found '9'", "1 to 8"});
  expect_tree_error({"--treelet-nodes", "0"}, {"--treelet-nodes: found '0'", "1 to 1024"});
  expect_tree_error({"--resident-nodes", "0"}, {"--resident-nodes: found '0'", "1 to 1024"});
  expect_tree_error({"--n", "9"}, {"--n: found '9'", "0 to 8"});
}

TEST_F(CommandLineErrors, Chip) {
  expect_render_error({"--chip", "csx601"}, {"'csx601'", "csx600,", "paper", ".toml"});
  expect_render_error({"--chip", "none.toml"}, {"none.toml"});
  expect_render_error({"--set", "pio.setup_cycle=3"}, {"--set", "'pio.setup_cycle'", "pio.setup_cycles"});
  expect_render_error({"--set", "pio.setup_cycles"}, {"--set", "'pio.setup_cycles'", "key=value"});
  expect_render_error({"--set", "pio.setup_cycles=many"}, {"--set", "pio.setup_cycles", "'many'"});
  expect_render_error({"--set", "chip.pes=97"}, {"--set", "chip.pes", "97"});
  write("chip.toml", "[pio]\nsetup_cycle = 3\n");
  expect_render_error({"--chip", "chip.toml"}, {"chip.toml:2", "pio.setup_cycle"});
  write("chip.toml", "[pio\n");
  expect_render_error({"--chip", "chip.toml"}, {"chip.toml:1"});
  expect_error({"params", "--chip", "csx601", "--json", "a.json"}, {"'csx601'"});
  expect_error({"reproduce", kCornellBox, "--set", "a.b=1", "--json", "a.json"}, {"'a.b'"});
}

TEST_F(CommandLineErrors, Memory) {
  for (const Words& how : {Words{}, Words{"--native"}}) {
    Words arguments = {"--set", "ddr.size_bytes=1048576", "--slot-vertices", "64"};
    arguments.insert(arguments.end(), how.begin(), how.end());
    expect_render_error(arguments, {"bytes of mono memory", "ddr.size_bytes", "1048576"});
  }
}

TEST_F(CommandLineErrors, PolySramOverflowShowsTheBufferMap) {
  for (const Words& how :
       {Words{"--n", "8", "--set", "poly.sram_bytes=4096"}, Words{"--bin-blocks", "400"},
        Words{"--bin-blocks", "400", "--native"}, Words{"--bin-blocks", "400", "--waves", "a.vcd"}}) {
    Words arguments = {"render", kCornellBox, "--size", "8x6", "--exr", "a.exr"};
    arguments.insert(arguments.end(), how.begin(), how.end());
    const CommandResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(files(), Words{});
    const Words lines = result.error_lines();
    ASSERT_GE(lines.size(), 4u) << result.error;
    EXPECT_TRUE(std::regex_search(lines[0], std::regex("^csx600: poly SRAM overflow: buffer '[^']+' needs "
                                                       "[0-9]+ bytes a PE, [0-9]+ of [0-9]+ are free")))
        << lines[0];
    EXPECT_TRUE(std::regex_search(lines[1], std::regex("offset +bytes +buffer"))) << lines[1];
    for (std::size_t i = 2; i < lines.size(); ++i)
      EXPECT_TRUE(std::regex_search(lines[i], std::regex("^ *[0-9]+ +[0-9]+  .+"))) << lines[i];
    EXPECT_NE(result.error.find("stack"), std::string::npos);
    EXPECT_NE(result.error.find("(free)"), std::string::npos);
  }
}

TEST_F(CommandLineErrors, MissingFiles) {
  expect_error({"render", "nowhere", "--exr", "a.exr"}, {"nowhere"});
  expect_error({"render", "nowhere.toml"}, {"nowhere.toml"});
  expect_error({"reproduce", "nowhere", "--json", "a.json"}, {"nowhere"});
  SceneFiles scene;
  scene.toml = replaced(scene.toml, "mesh.obj", "none.obj");
  expect_scene_error(scene, {"none.obj"});
  scene = {};
  scene.obj = replaced(scene.obj, "mtllib mesh.mtl", "mtllib .");
  expect_scene_error(scene, {"mesh.obj:1: mtllib", "a regular file"});
}

TEST_F(CommandLineErrors, BrokenScene) {
  struct Case {
    const char* name;
    std::function<void(SceneFiles&)> breaks;
    Words parts;
  };
  const Case cases[] = {
      {"TOML", [](SceneFiles& s) { s.toml += "x = [\n"; }, {"scene.toml", "TOML"}},
      {"no camera",
       [](SceneFiles& s) { s.toml = "[film]\nwidth = 8\n[[mesh]]\nfile = \"mesh.obj\"\n"; },
       {"scene.toml", "camera"}},
      {"unknown key",
       [](SceneFiles& s) { s.toml = replaced(s.toml, "width", "widht"); },
       {"scene.toml:6", "film.widht"}},
      {"empty film",
       [](SceneFiles& s) { s.toml = replaced(s.toml, "width = 8", "width = 0"); },
       {"scene.toml:6", "film.width", "found 0"}},
      {"text for a number",
       [](SceneFiles& s) { s.toml = replaced(s.toml, "= 40", "= \"wide\""); },
       {"scene.toml:4", "vertical_fov_degrees"}},
      {"no mesh",
       [](SceneFiles& s) { s.toml = s.toml.substr(0, s.toml.find("[[mesh]]")); },
       {"scene.toml", "mesh"}},
      {"vertex index",
       [](SceneFiles& s) { s.obj = replaced(s.obj, "f 1 2 3", "f 1 2 9"); },
       {"mesh.obj", "9", "1 to 3"}},
      {"vertex",
       [](SceneFiles& s) { s.obj = replaced(s.obj, "v 0 1 0", "v 0 one 0"); },
       {"mesh.obj:4", "one"}},
      {"material",
       [](SceneFiles& s) { s.mtl = replaced(s.mtl, "Ke 1 2 3", "Ke 1 2 x"); },
       {"mesh.mtl", "light", "1 2 x"}},
      {"no faces", [](SceneFiles& s) { s.obj = replaced(s.obj, "f 1 2 3", ""); }, {"mesh"}},
  };
  for (const Case& broken : cases) {
    SCOPED_TRACE(broken.name);
    SceneFiles scene;
    broken.breaks(scene);
    expect_scene_error(scene, broken.parts);
  }
}

TEST_F(CommandLineErrors, NotesDoNotGoBeforeAnError) {
  SceneFiles scene;
  scene.obj += "f 1 1 2\n";
  write("scene.toml", scene.toml);
  write("mesh.obj", scene.obj);
  write("mesh.mtl", scene.mtl);
  expect_error({"render", "scene.toml", "--n", "8", "--bin-blocks", "7"}, {"n: found 8"});
}

TEST_F(CommandLineErrors, UnwritableOutputsAreFoundBeforeTheRun) {
  const auto expect_output_error = [this](const char* option, const std::string& file, const Words& parts) {
    expect_error({"render", kCornellBox, "--samples", "100000000", option, file}, parts);
  };
  for (const char* option :
       {"--exr", "--png", "--stats", "--json", "--waves", "--transactions", "--timeline"}) {
    expect_output_error(option, "none/a.vcd", {"none/a.vcd"});
    expect_output_error(option, "/dev/null/a.vcd", {"/dev/null/a.vcd"});
  }
  expect_output_error("--exr", ".", {"directory"});
  expect_output_error("--png", "/dev/null", {"/dev/null"});
  expect_error({"params", "--json", "none/a.json"}, {"none/a.json"});
  expect_error({"reproduce", kCornellBox, "--json", "none/a.json"}, {"none/a.json"});
}

TEST_F(CommandLineErrors, OutputsInOneFile) {
  expect_error({"render", kCornellBox, "--exr", "a", "--png", "./a"}, {"--exr", "--png", "./a"});
  expect_error({"render", kCornellBox, "--waves", "a.vcd", "--stats", "a.vcd"}, {"--waves", "--stats"});
}

TEST_F(CommandLineErrors, Calibrate) {
  const auto expect_calibrate_error = [this](const Words& arguments, const Words& parts) {
    Words all = {"calibrate", kCornellBox};
    all.insert(all.end(), arguments.begin(), arguments.end());
    expect_error(all, parts);
  };
  for (const char* size : {"0x5", "5", "16385x1", "5x5x5"})
    expect_calibrate_error({"--size", size, "--write", "a.hpp", "--json", "a.json"},
                           {"--size", std::string("'") + size + "'", "1 to 16384"});
  for (const char* option : {"--write", "--json"}) {
    expect_calibrate_error({option, "none/a.hpp"}, {"none/a.hpp"});
    expect_calibrate_error({option, "."}, {"directory"});
  }
  expect_calibrate_error({"--write", "a", "--json", "./a"}, {"--write", "--json", "./a"});
  expect_calibrate_error({"--samples", "0"}, {"--samples", "1 to"});
  expect_calibrate_error({"--chip", "csx601"}, {"'csx601'"});
  expect_calibrate_error({"--alternatives", "--closed-scene", "nowhere"}, {"nowhere"});
  expect_error({"calibrate", "nowhere", "--json", "a.json"}, {"nowhere"});
}

/// A chip so slow that no constants make it as fast as the paper's.
TEST_F(CommandLineErrors, ConstantsThatMeetNothingAreNotWritten) {
  const CommandResult result = run({"calibrate", kCornellBox, "--size", "16x16", "--samples", "1", "--set",
                                    "chip.clock_hz=10000000", "--write", "a.hpp"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.out.find("cannot be met"), std::string::npos) << result.out;
  EXPECT_NE(result.error.find("\ncsx600: --write: "), std::string::npos) << result.error;
  EXPECT_EQ(files(), Words{});
}

TEST_F(CommandLineErrors, Waves) {
  expect_render_error({"--waves", "a.vcd", "--native"}, {"--waves", "--native"});
  expect_render_error({"--timeline", "a.json", "--native"}, {"--timeline", "--native"});
  expect_render_error({"--waves", "a.txt"}, {"--waves", "a.txt", ".vcd", ".fst"});
  for (const char* window : {"5", "5:2", "5:5", "a:b", "-1:5", "1:2:3", "1:-2", "1ms:1us", "1x:2x",
                             "2h:", "nan s:", "-1ms:", "1e30s:"})
    expect_render_error({"--waves", "a.vcd", "--waves-window", window}, {"--waves-window", window});
  for (const char* blocks : {"0", "1:0", "a", "", "1:", ":2", "1:2:3", "-1"})
    expect_render_error({"--waves", "a.vcd", "--waves-blocks=" + std::string(blocks)},
                        {"--waves-blocks", blocks});
  for (const char* pes : {"96", "5-2", "a", "1,", ",1", "1-", "-1", "0,,1"})
    expect_render_error({"--waves", "a.vcd", "--waves-pes=" + std::string(pes)},
                        {"--waves-pes", pes, "0 to 95"});
  expect_render_error({"--waves", "a.vcd", "--waves-level", "all"}, {"--waves-level", "all"});
  expect_render_error({"--waves", "a.fst", "--waves-signals", "pio.*", "--waves-signals", "none.*"},
                      {"'none.*'", "csx600 waves"});
  expect_render_error({"--waves", "a.vcd", "--waves-signals", "ddr.data", "--waves-level", "overview"},
                      {"leaves no signal"});
  for (const Words& alone :
       {Words{"--waves-window", "1:2"}, Words{"--waves-blocks", "1"}, Words{"--waves-signals", "*"},
        Words{"--waves-pes", "1"}, Words{"--waves-level", "units"}})
    expect_render_error(alone, {alone[0], "without --waves"});
}

TEST_F(CommandLineErrors, WavesWithoutTheConverter) {
  const char* const path = std::getenv("PATH");
  const std::string before = path == nullptr ? "" : path;
  setenv("PATH", "/nowhere", 1);
  expect_render_error({"--waves", "a.fst"}, {"a.fst", "vcd2fst", "gtkwave", ".vcd"});
  setenv("PATH", before.c_str(), 1);
}

TEST_F(CommandLineErrors, WindowAfterTheRunFailsItButLosesNoImage) {
  const CommandResult result = run({"render", kCornellBox, "--size", "8x6", "--samples", "1", "--exr",
                                    "a.exr", "--waves", "a.vcd", "--waves-window", "999999999999:"});
  EXPECT_EQ(result.exit_code, 1);
  ASSERT_EQ(result.error_lines().size(), 1u) << result.error;
  for (const char* part : {"a.vcd", "window", "999999999999"})
    EXPECT_NE(result.error.find(part), std::string::npos) << result.error;
  EXPECT_EQ(files(), Words{"a.exr"});
}

}  // namespace command_line_errors_test
