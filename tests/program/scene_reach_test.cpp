// What holds for every command that loads scenes: how far scenes may reach, and notes on what was left out.

#include <algorithm>

#include "tests/support/command_line.hpp"

namespace scene_reach_test {

using test_support::CommandResult;
using Words = std::vector<std::string>;

class SceneReach : public test_support::CommandLineFixture {
 protected:
  /// A scene whose mesh lies beside its folder and has a face of the default material and one without area.
  SceneReach() {
    test_support::SceneFiles scene;
    scene.toml.replace(scene.toml.find("mesh.obj"), 8, "../mesh.obj");
    write("box/scene.toml", scene.toml);
    write("mesh.obj", "v 0 0 -1\nv 1 0 -1\nv 0 1 -1\nf 1 2 3\nf 1 2 2\n" + scene.obj.substr(0, 16) +
                          "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nusemtl light\nf 4 5 6\n");
    write("mesh.mtl", scene.mtl);
    write("grid/grid.toml",
          "width = 4\nheight = 3\nsamples = 1\n[[grid]]\nscene = [\"../box\"]\nchip = [\"csx600\", "
          "\"paper\"]\n");
    write(
        "sweep.toml",
        "scene = \"box\"\nsamples = 1\n[[axis]]\nfirmware.n = [1, 2]\n[[axis]]\nsize = [\"4x3\", \"5x3\"]\n");
  }

  static int notes_in(const CommandResult& result, const std::string& text) {
    const Words lines = result.error_lines();
    return int(std::count_if(lines.begin(), lines.end(), [&](const std::string& line) {
      return line.rfind("csx600: note: ", 0) == 0 && line.find(text) != std::string::npos;
    }));
  }

  /// Expects the command to be refused without --allow-outside, and with it to note each thing once.
  void expect_flag_and_notes(const Words& command) {
    SCOPED_TRACE(testing::PrintToString(command));
    const CommandResult refused = run(command);
    EXPECT_EQ(refused.exit_code, 2);
    ASSERT_EQ(refused.error_lines().size(), 1u) << refused.error;
    EXPECT_NE(refused.error.find("outside the scene's folder"), std::string::npos) << refused.error;
    EXPECT_NE(refused.error.find("--allow-outside"), std::string::npos) << refused.error;
    Words allowed = command;
    allowed.emplace_back("--allow-outside");
    const CommandResult done = run(allowed);
    EXPECT_EQ(done.exit_code, 0) << done.error;
    EXPECT_EQ(notes_in(done, "default material"), 1) << done.error;
    EXPECT_EQ(notes_in(done, "without area"), 1) << done.error;
  }
};

TEST_F(SceneReach, OfRendersAndBenchmarks) {
  expect_flag_and_notes({"render", "box", "--samples", "1", "--native"});
  expect_flag_and_notes({"bench", "timing", "box", "--samples", "1"});
  expect_flag_and_notes({"bench", "reference", "box", "--samples", "2", "-o", "r.exr"});
  expect_flag_and_notes({"bench", "error", "box", "--reference", "r.exr", "--samples", "2", "--native"});
  expect_flag_and_notes({"bench", "speed", "box", "--samples", "1", "--repetitions", "1"});
}

TEST_F(SceneReach, OfTheToolsOfThePaper) {
  expect_flag_and_notes({"reproduce", "box", "--samples", "1"});
  expect_flag_and_notes({"calibrate", "box", "--size", "2x2", "--samples", "1"});
}

TEST_F(SceneReach, OfSweepsAndGoldenRuns) {
  expect_flag_and_notes({"sweep", "sweep.toml", "-o", "points"});
  const CommandResult golden = run({"golden", "grid", "--update", "--allow-outside"});
  EXPECT_EQ(golden.exit_code, 0) << golden.error;
  expect_flag_and_notes({"golden", "grid"});
}

}  // namespace scene_reach_test
