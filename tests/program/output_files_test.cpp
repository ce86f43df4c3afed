// Outputs replace neither an input nor one another, however their paths are spelled.

#include <cstring>

#include "tests/support/command_line.hpp"

namespace output_files_test {

using test_support::CommandResult;
using Words = std::vector<std::string>;

class OutputFiles : public test_support::CommandLineFixture {
 protected:
  OutputFiles() {
    const test_support::SceneFiles scene;
    write("box/scene.toml", scene.toml);
    write("box/mesh.obj", scene.obj);
    write("box/mesh.mtl", scene.mtl);
    write("chip.toml", "preset = \"csx600\"\n");
    std::filesystem::create_directory_symlink("box", directory() / "link");
    std::filesystem::create_symlink("box/mesh.obj", directory() / "mesh.png");
  }

  /// Expects the command to be refused with a line that has all `parts`, and every file to be as it was.
  void expect_refused(const Words& arguments, const Words& parts) {
    SCOPED_TRACE(testing::PrintToString(arguments));
    const std::vector<std::pair<std::string, std::string>> before = contents();
    const CommandResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(result.error_lines().size(), 1u) << result.error;
    for (const std::string& part : parts)
      EXPECT_NE(result.error.find(part), std::string::npos) << part << " in: " << result.error;
    EXPECT_EQ(contents(), before);
  }
  void expect_render_refused(const Words& arguments, const Words& parts) {
    Words all = {"render", "box", "--samples", "1"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    expect_refused(all, parts);
  }
  std::vector<std::pair<std::string, std::string>> contents() const {
    std::vector<std::pair<std::string, std::string>> all;
    for (const std::string& name : files()) all.emplace_back(name, read(name));
    return all;
  }
};

TEST_F(OutputFiles, NoOutputReplacesAFileOfTheScene) {
  for (const char* path : {"box/scene.toml", "./box/../box/mesh.obj", "link/mesh.mtl", "mesh.png"}) {
    expect_render_refused({"--png", path}, {"--png", path, "scene box"});
    expect_render_refused({"--native", "--stats", path}, {"--stats", path, "scene box"});
  }
  expect_render_refused({"--timeline", "box/mesh.obj"}, {"--timeline", "box/mesh.obj"});
  for (const Words& command : {Words{"bench", "speed", "box", "--csv", "box/mesh.mtl"},
                               Words{"bench", "timing", "box", "--json", "box/mesh.mtl"},
                               Words{"bench", "reference", "box", "--output", "box/mesh.mtl"},
                               Words{"reproduce", "box", "--json", "box/mesh.mtl"},
                               Words{"calibrate", "box", "--write", "box/mesh.mtl"}})
    expect_refused(command, {"box/mesh.mtl", "an input"});
}

TEST_F(OutputFiles, NoOutputReplacesWhatAGltfFileNames) {
  const float corners[] = {-1, -1, 0, 1, -1, 0, 0, 1, 0};
  std::string bytes(sizeof(corners), ' ');
  std::memcpy(bytes.data(), corners, sizeof(corners));
  write("gltf/a b.bin", bytes);
  write("gltf/s.gltf", R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
    "nodes": [{"mesh": 0}, {"camera": 0, "translation": [0, 0, 5]}],
    "cameras": [{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
    "materials": [{"emissiveFactor": [1, 1, 1]}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [-1, -1, 0],
                   "max": [1, 1, 0]}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"uri": "a%20b.bin", "byteLength": 36}]})");
  for (const char* path : {"gltf/a b.bin", "gltf/s.gltf"})
    expect_refused({"render", "gltf/s.gltf", "--samples", "1", "--png", path}, {"--png", path, "an input"});
}

TEST_F(OutputFiles, NoOutputReplacesTheChipFile) {
  expect_render_refused({"--chip", "chip.toml", "--stats", "chip.toml"}, {"--stats", "chip.toml", "--chip"});
  expect_refused({"params", "--chip", "./chip.toml", "--json", "chip.toml"}, {"--json", "--chip"});
}

TEST_F(OutputFiles, NoOutputReplacesStatistics) {
  ASSERT_EQ(run({"render", "box", "--samples", "1", "--stats", "a.json", "--png", "a.png"}).exit_code, 0);
  expect_refused({"stats", "a.json", "-o", "./a.json"}, {"--output", "./a.json", "statistics"});
  expect_refused({"report", "a.json", "-o", "link/../a.json"}, {"--output", "a.json", "the input"});
  expect_refused({"report", "a.json", "--image", "a.png", "-o", "a.png"}, {"--output", "--image"});
}

TEST_F(OutputFiles, WhatComesWithWavesIsAnOutputToo) {
  expect_render_refused({"--waves", "a.vcd", "--stats", "a.gtkw"}, {"--stats", "a.gtkw", "--waves"});
  expect_render_refused({"--waves", "a.vcd", "--exr", "a.control_state.txt"}, {"--exr", "--waves"});
  write("box/chip.gtkw", "");
  std::filesystem::create_hard_link(directory() / "chip.toml", directory() / "waves.gtkw");
  expect_render_refused({"--waves", "waves.vcd", "--chip", "chip.toml"}, {"waves.gtkw", "--chip"});
}

TEST_F(OutputFiles, TwoOutputsAreTwoFiles) {
  expect_render_refused({"--exr", "box/new", "--png", "link/new"}, {"--png", "link/new", "--exr"});
  std::filesystem::create_hard_link(directory() / "chip.toml", directory() / "other");
  expect_render_refused({"--exr", "chip.toml", "--png", "other"}, {"--png", "other", "--exr"});
}

TEST_F(OutputFiles, AnEmptyNameIsNone) {
  for (const char* option : {"--exr", "--png", "--stats", "--waves", "--transactions", "--timeline"})
    expect_render_refused({option, ""}, {option, "the name of a file"});
  expect_refused({"report", "a.json", "-o", ""}, {"--output", "the name of a file"});
  expect_refused({"scene", "blob", "-o", ""}, {"--output", "the name of a file"});
}

TEST_F(OutputFiles, ASceneIsReplacedOnRequestOnly) {
  expect_refused({"scene", "blob", "-o", "box"}, {"box/", "--force"});
  write("mine/scene.toml", "# mine\n");
  expect_refused({"scene", "blob", "-o", "mine"}, {"mine/scene.toml", "--force"});
  EXPECT_EQ(run({"scene", "blob", "-o", "mine", "--force"}).exit_code, 0);
  EXPECT_EQ(run({"render", "mine", "--native", "--size", "4x4", "--samples", "1"}).exit_code, 0);
}

TEST_F(OutputFiles, TheSweepFileIsNoResult) {
  write("out/sweep.csv",
        "scene = \"" + (directory() / "box").string() + "\"\n[[axis]]\nfirmware.n = [1, 2]\n");
  expect_refused({"sweep", "out/sweep.csv", "-o", "out"}, {"out/sweep.csv", "sweep file"});
}

TEST_F(OutputFiles, APathThatIsNotUtf8CostsNoRender) {
  const std::string name = "b\xff\nx";
  std::filesystem::rename(directory() / "box", directory() / name);
  const CommandResult result = run(
      {"render", name, "--native", "--samples", "1", "--exr", "a.exr", "--stats", "a.json", "--stats-text"});
  EXPECT_EQ(result.exit_code, 0) << result.error;
  EXPECT_EQ(result.error, "");
  EXPECT_NE(result.out.find("\nb\\xff\\nx, 8 x 6"), std::string::npos) << result.out;
  EXPECT_NE(read("a.json").find("\"scene\": \"b\xef\xbf\xbd\\nx\""), std::string::npos);
  EXPECT_EQ(run({"stats", "a.json"}).exit_code, 0);
}

}  // namespace output_files_test
