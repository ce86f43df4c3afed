// What cannot be printed is an error of every command; what is said of a wrong command line.

#include <sys/wait.h>

#include <cstdlib>

#include "tests/support/command_line.hpp"

namespace standard_output_test {

using test_support::CommandResult;

class StandardOutput : public test_support::CommandLineFixture {
 protected:
  StandardOutput() {
    const test_support::SceneFiles scene;
    write("scene.toml", scene.toml);
    write("mesh.obj", scene.obj);
    write("mesh.mtl", scene.mtl);
  }

  /// The exit code of "csx600 ARGUMENTS" with a redirection; its errors are in "errors".
  int shell(const std::string& arguments, const std::string& redirection) const {
    const std::string command =
        "cd '" + directory().string() + "' && '" CSX600_BINARY "' " + arguments + " 2>errors " + redirection;
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
};

TEST_F(StandardOutput, AFullDiskIsAnErrorOfEveryCommand) {
  ASSERT_EQ(shell("render scene.toml --samples 1 --stats a.json", ">/dev/null"), 0) << read("errors");
  for (const char* arguments :
       {"params", "params --markdown", "waves", "stats a.json", "stats --describe", "compare a.json a.json",
        "report a.json", "scene blob -o new", "render scene.toml --native --samples 1 --stats-text",
        "completion bash", "man", "--version", "--help", "render --help"}) {
    EXPECT_EQ(shell(arguments, ">/dev/full"), 1) << arguments;
    EXPECT_EQ(read("errors"), "csx600: standard output: write error: No space left on device\n") << arguments;
  }
}

TEST_F(StandardOutput, AClosedOutputIsAnErrorAndNoFileTakesItsPlace) {
  for (const char* arguments :
       {"params --json a.json", "render scene.toml --native --samples 1 --png a.png"}) {
    EXPECT_EQ(shell(arguments, ">&-"), 1) << arguments;
    EXPECT_EQ(read("errors"), "csx600: standard output: write error: Bad file descriptor\n") << arguments;
  }
  EXPECT_EQ(read("a.json").rfind("[\n", 0), 0u);
  EXPECT_EQ(read("a.png").substr(1, 3), "PNG");
  EXPECT_EQ(read("a.png").find("segments"), std::string::npos);
}

TEST_F(StandardOutput, AnErrorOfTheInputComesFirst) {
  EXPECT_EQ(shell("render nowhere", ">/dev/full"), 2);
  EXPECT_EQ(read("errors").find("standard output"), std::string::npos) << read("errors");
}

TEST_F(StandardOutput, AWrongNameIsNamedWithTheNearest) {
  const auto expect = [this](const std::vector<std::string>& arguments, const std::string& line) {
    const CommandResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.error, "csx600: " + line + " (see csx600 --help)\n");
  };
  expect({"paint"}, "paint: unknown command; did you mean 'params'?");
  expect({"rnder", "scene.toml"}, "rnder: unknown command; did you mean 'render'?");
  expect({"vaves"}, "vaves: unknown command; did you mean 'waves'?");
  expect({"bench", "referense"}, "referense: unknown command; did you mean 'reference'?");
  expect({"render", "scene.toml", "--sampels", "3"}, "--sampels: unknown option; did you mean '--samples'?");
  expect({"render", "scene.toml", "--expr=a"}, "--expr: unknown option; did you mean '--exr'?");
  const std::string none = run({"zzzzzzzz"}).error;
  EXPECT_NE(none.find("zzzzzzzz: unknown command; allowed is one of render, "), std::string::npos) << none;
}

TEST_F(StandardOutput, MessagesAreOneShortPrintableLine) {
  const std::string hostile = "a\n\x1b[31m\xff" + std::string(5000, 'w');
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{hostile},
                                                    {"render", hostile},
                                                    {"render", "scene.toml", "--size", hostile},
                                                    {"render", "scene.toml", "--set", hostile},
                                                    {"render", "scene.toml", "--set", hostile + "=1"},
                                                    {"render", "scene.toml", "--set", "chip.pes=" + hostile},
                                                    {"render", "scene.toml", "--n", hostile},
                                                    {"render", "scene.toml", "--chip", hostile},
                                                    {"stats", hostile},
                                                    {"report", hostile},
                                                    {"render", "scene.toml", "--" + hostile},
                                                    {"render", "scene.toml", "--png", hostile + "/a"}}) {
    const CommandResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.error_lines().size(), 1u) << result.error;
    EXPECT_LT(result.error.size(), 1000u) << result.error;
    for (const char c : result.error) EXPECT_TRUE(c == '\n' || (c >= ' ' && c <= '~')) << int(c);
  }
}

TEST_F(StandardOutput, NumbersOutOfRangeAreRefusedWithAShortRange) {
  for (const auto& [option, number] : {std::pair("--seed", "18446744073709551616"),
                                       {"--seed", "1e3"},
                                       {"--max-survival", "1e400"},
                                       {"--max-survival", "nan"},
                                       {"--samples", "1e400"},
                                       {"--samples", "4294967297"}}) {
    const CommandResult result = run({"render", "scene.toml", option, number});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_NE(result.error.find(std::string(option) + ": found '" + number + "', allowed is "),
              std::string::npos)
        << result.error;
    EXPECT_LT(result.error.size(), 200u) << result.error;
  }
}

TEST_F(StandardOutput, ABlackFilmSaysWhy) {
  test_support::SceneFiles scene;
  scene.obj.replace(scene.obj.find("f 1 2 3"), 7, "f 3 2 1");
  write("mesh.obj", scene.obj);
  const CommandResult result = run({"render", "scene.toml", "--samples", "1"});
  EXPECT_EQ(result.exit_code, 0);
  ASSERT_EQ(result.error_lines().size(), 1u) << result.error;
  EXPECT_EQ(result.error.rfind("csx600: note: every pixel is black: every light faces away", 0), 0u)
      << result.error;
}

}  // namespace standard_output_test
