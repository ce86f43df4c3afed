// What describes the whole command line: --version, shell completion, the man page.

#include <algorithm>
#include <array>
#include <cstdio>
#include <sstream>

#include "firmware/path_tracer/program/program_options.hpp"
#include "tests/support/command_line.hpp"

namespace command_tree_test {

using test_support::CommandResult;
using Words = std::vector<std::string>;

class CommandTree : public test_support::CommandLineFixture {
 protected:
  std::string printed(const Words& arguments) {
    const CommandResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.error;
    EXPECT_EQ(result.error, "");
    return result.out;
  }
  /// What a shell command prints, from the fixture's directory; standard error comes with it.
  std::string shell(const std::string& command) {
    std::FILE* const pipe = popen(("cd '" + directory().string() + "' && " + command + " 2>&1").c_str(), "r");
    std::string text;
    std::array<char, 4096> buffer;
    for (std::size_t got = 0; (got = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
      text.append(buffer.data(), got);
    EXPECT_EQ(pclose(pipe), 0) << text;
    return text;
  }
  /// What bash offers behind these words, the last of which is being typed.
  Words offered(const std::string& words) {
    write("completion.bash", printed({"completion", "bash"}));
    write("complete.bash",
          "source completion.bash\n"
          "[[ $(complete -p csx600) == *_csx600* ]] || echo 'not registered'\n"
          "COMP_WORDS=(" +
              words +
              ") COMP_CWORD=$((${#COMP_WORDS[@]} - 1)) COMPREPLY=()\n"
              "_csx600\nprintf '%s\\n' \"${COMPREPLY[@]}\"\n");
    std::istringstream lines(shell("bash complete.bash"));
    Words found;
    for (std::string line; std::getline(lines, line);)
      if (!line.empty()) found.push_back(line);
    return found;
  }
};

TEST_F(CommandTree, VersionNamesProgramSystemCAndKernels) {
  const std::string version = printed({"--version"});
  EXPECT_EQ(version.rfind("csx600 " CSX600_VERSION "\nSystemC ", 0), 0u) << version;
  EXPECT_NE(version.find("\nkernels for x86-64-v"), std::string::npos) << version;
}

TEST_F(CommandTree, BashCompletesCommandsOptionsAndValues) {
  EXPECT_EQ(offered("csx600 ren"), Words{"render"});
  EXPECT_EQ(offered("csx600 render --trav"), Words{"--traversal"});
  EXPECT_EQ(offered("csx600 render --tra"), (Words{"--traversal", "--transactions"}));
  const Words traversals(path_tracer::kTraversalNames.begin(), path_tracer::kTraversalNames.end());
  EXPECT_EQ(offered("csx600 render --traversal ''"), traversals);
  EXPECT_EQ(offered("csx600 render scene --traversal re"), Words{"refill"});
  EXPECT_EQ(offered("csx600 render scene --traversal = re"), Words{"refill"});
  EXPECT_EQ(offered("csx600 render --traversal ="), traversals);
  EXPECT_EQ(offered("csx600 render --seed ''"), Words{});
  EXPECT_EQ(offered("csx600 bench e"), Words{"error"});
  EXPECT_EQ(offered("csx600 bench error --sampler ''"), (Words{"philox", "sobol"}));
  EXPECT_EQ(offered("csx600 scene s"), (Words{"sphere_flake", "stadium"}));
  EXPECT_EQ(offered("csx600 --v"), Words{"--version"});
  EXPECT_EQ(offered("csx600 paint"), Words{});
}

TEST_F(CommandTree, BashCompletesFilesWhereOneIsTaken) {
  write("box image.exr", "");
  for (const char* words :
       {"csx600 render box", "csx600 render --exr box", "csx600 stats box", "csx600 render --chip box"})
    EXPECT_EQ(offered(words), Words{"box image.exr"}) << words;
  EXPECT_EQ(offered("csx600 render --level box"), Words{});
  EXPECT_EQ(offered("csx600 waves box"), Words{});
}

TEST_F(CommandTree, EveryFirmwareOptionIsCompletedAndInTheManPage) {
  const Words options = offered("csx600 render --");
  const std::string man = printed({"man"});
  for (const path_tracer::ProgramOption& option : path_tracer::program_options()) {
    std::string name = "--" + option.name;
    std::string escaped = "\\-\\-";
    for (char& c : name)
      if (c == '_') c = '-';
    for (const char c : name.substr(2)) escaped += c == '-' ? "\\-" : std::string(1, c);
    EXPECT_EQ(std::count(options.begin(), options.end(), name), 1) << name;
    EXPECT_NE(man.find("\n\\fB" + escaped + "\\fR"), std::string::npos) << escaped;
  }
}

TEST_F(CommandTree, ManPageHasItsSectionsAndNoWarnings) {
  write("csx600.1", printed({"man"}));
  const std::string page = read("csx600.1");
  for (const char* part :
       {".TH CSX600 1", ".SH NAME", ".SH SYNOPSIS", ".SH COMMANDS", ".SS csx600 bench error [OPTIONS] scene",
        ".SH EXIT STATUS", ".SH FILES", ".SH EXAMPLES", ".SH SEE ALSO", "Default: the scene's."})
    EXPECT_NE(page.find(part), std::string::npos) << part;
  if (std::string(GROFF).empty()) GTEST_SKIP() << "no groff";
  EXPECT_EQ(shell(std::string(GROFF) + " -man -Tutf8 -ww csx600.1 >page.txt"), "");
  EXPECT_NE(read("page.txt").find("wrong"), std::string::npos);
}

}  // namespace command_tree_test
