// Machines that have too little: disks that become full in the middle of a file, memory that is not there,
// and names that are not UTF-8. One line, and nothing half written.

#include <sys/resource.h>

#include <csignal>
#include <nlohmann/json.hpp>

#include "tests/support/command_line.hpp"

namespace limited_machine_test {

using test_support::CommandResult;
using Words = std::vector<std::string>;

const std::string kCornellBox = std::string(CSX600_SCENES_DIR) + "/cornell_box";

/// Lowers a limit of this process, and so of the programs that it starts.
class Limit {
 public:
  Limit(__rlimit_resource resource, rlim_t value) : resource_(resource) {
    getrlimit(resource, &before_);
    const rlimit lower{value, before_.rlim_max};
    setrlimit(resource, &lower);
  }
  ~Limit() { setrlimit(resource_, &before_); }
  Limit(const Limit&) = delete;
  Limit& operator=(const Limit&) = delete;

 private:
  __rlimit_resource resource_;
  rlimit before_{};
};

class LimitedMachine : public test_support::CommandLineFixture {
 protected:
  LimitedMachine() : signal_(std::signal(SIGXFSZ, SIG_IGN)) {}
  ~LimitedMachine() override { std::signal(SIGXFSZ, signal_); }

  void expect_failure(const Words& arguments, const Words& parts) {
    SCOPED_TRACE(testing::PrintToString(arguments));
    const Words before = files();
    const CommandResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 1);
    ASSERT_FALSE(result.error_lines().empty());
    const Words lines = result.error_lines();
    for (std::size_t i = 0; i + 1 < lines.size(); ++i)
      EXPECT_EQ(lines[i].rfind("csx600: note: ", 0), 0u) << lines[i];
    for (const std::string& part : parts)
      EXPECT_NE(lines.back().find(part), std::string::npos) << part << " in: " << lines.back();
    EXPECT_EQ(files(), before) << "left behind";
  }

 private:
  void (*signal_)(int);
};

/// A file may hold 3000 bytes, then writing fails as on a full disk.
TEST_F(LimitedMachine, NoOutputIsHalfWritten) {
  Words outputs[] = {{"--exr", "a.exr"},       {"--png", "a.png"},   {"--stats", "a.json"},
                     {"--stats", "a.csv"},     {"--waves", "a.vcd"}, {"--transactions", "a.jsonl"},
                     {"--timeline", "a.json"}, {"--png", "a.png"}};
  for (const Words& output : outputs) {
    const Limit limit(RLIMIT_FSIZE, 3000);
    Words arguments = {"render", kCornellBox, "--size", "64x64", "--samples", "1"};
    arguments.insert(arguments.end(), output.begin(), output.end());
    expect_failure(arguments, {output[1], "cannot be written", "File too large"});
  }
  const Limit limit(RLIMIT_FSIZE, 3000);
  expect_failure({"scene", "blob", "--triangles", "500", "-o", "blob"}, {"blob", "cannot be written"});
  EXPECT_FALSE(std::filesystem::exists(directory() / "blob"));
  expect_failure({"params", "--json", "p.json"}, {"p.json", "cannot be written"});
}

TEST_F(LimitedMachine, NoChartIsHalfDrawn) {
  ASSERT_EQ(
      run({"bench", "reference", kCornellBox, "--size", "8x8", "--samples", "2", "-o", "r.exr"}).exit_code,
      0);
  for (const char* chart : {"c.png", "c.svg"}) {
    const Words command = {"bench",    "error",     kCornellBox, "--reference", "r.exr",
                           "--native", "--samples", "2",         "--plot",      chart};
    const CommandResult whole = run(command);
    EXPECT_EQ(whole.exit_code, 0) << whole.error;
    if (!std::filesystem::remove(directory() / chart)) GTEST_SKIP() << "gnuplot is not installed";
    const Limit limit(RLIMIT_FSIZE, 3000);
    const CommandResult cut = run(command);
    EXPECT_EQ(cut.exit_code, 1);
    EXPECT_NE(cut.error.find(std::string(chart) + ": "), std::string::npos) << cut.error;
    EXPECT_EQ(files(), Words{"r.exr"});
  }
}

TEST_F(LimitedMachine, ASweepKeepsWhatItHasFinished) {
  write("s.toml", "scene = \"" + kCornellBox +
                      "\"\nsize = \"4x3\"\nsamples = 1\n[[axis]]\npio.setup_cycles = [1, 2, 3, 4]\n");
  {
    const Limit limit(RLIMIT_FSIZE, 30'000);  // room for two points, as files are today
    const CommandResult full = run({"sweep", "s.toml", "-o", "out", "--jobs", "1"});
    EXPECT_EQ(full.exit_code, 1);
    EXPECT_NE(full.error.find("out/points.jsonl: cannot be written"), std::string::npos) << full.error;
    EXPECT_EQ(files(), (Words{"out/points.jsonl", "s.toml"}));
    EXPECT_EQ(read("out/points.jsonl").back(), '\n') << "no piece of a line";
  }
  const CommandResult rest = run({"sweep", "s.toml", "-o", "out"});
  EXPECT_EQ(rest.exit_code, 0) << rest.error;
  EXPECT_EQ(rest.out.find("; 0 were there"), std::string::npos) << rest.out;
}

TEST_F(LimitedMachine, AFilmThatDoesNotFitIsOneLine) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "AddressSanitizer needs more address space than the limit";
#endif
  const Limit limit(RLIMIT_AS, rlim_t{2} << 30);
  for (const Words& how : {Words{}, Words{"--native"}}) {
    Words arguments = {"render", kCornellBox, "--size", "16384x16384", "--samples", "1", "--png", "a.png"};
    arguments.insert(arguments.end(), how.begin(), how.end());
    expect_failure(arguments, {"out of memory"});
  }
}

/// A name in Latin-1, as old archives have them.
TEST_F(LimitedMachine, NamesThatAreNotUtf8CostNoRun) {
  const std::string name = "caf\xe9";
  const test_support::SceneFiles scene;
  write(name + "/scene.toml", scene.toml);
  write(name + "/mesh.obj", scene.obj);
  write(name + "/mesh.mtl", scene.mtl);
  const std::string replaced = "caf\xef\xbf\xbd";
  const auto expect_done = [&](const Words& arguments) {
    const CommandResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 0) << testing::PrintToString(arguments) << result.error;
  };
  for (const Words& how : {Words{}, Words{"--native"}}) {
    Words arguments = {"render", name, "--samples", "1", "--exr", name + ".exr", "--stats", name + ".json"};
    arguments.insert(arguments.end(), how.begin(), how.end());
    expect_done(arguments);
    EXPECT_EQ(nlohmann::json::parse(read(name + ".json"))["scene"], replaced);
  }
  expect_done({"report", name + ".json", "-o", name + ".html"});
  write("s.toml", "size = \"4x3\"\nsamples = 1\n[[axis]]\npio.setup_cycles = [1, 2, 3]\n");
  expect_done({"sweep", "s.toml", "--set", "scene=" + name, "-o", name + ".sweep"});
  EXPECT_EQ(nlohmann::json::parse(read(name + ".sweep/sweep.json"))["points"].size(), 3u);
  expect_done({"sweep", "s.toml", "--set", "scene=" + name, "-o", name + ".sweep"});
  expect_done({"bench", "timing", name, "--samples", "1", "--json", name + "_timing.json"});
}

}  // namespace limited_machine_test
