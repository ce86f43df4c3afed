// --checkpoint and --resume of `csx600 render`: after a kill at any moment, the same bits.

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/support/command_line.hpp"

namespace checkpoint_command_test {

using Json = nlohmann::ordered_json;
using test_support::CommandResult;
using Words = std::vector<std::string>;

class CheckpointCommand : public test_support::CommandLineFixture {
 protected:
  /// Four passes.
  Words command(const Words& more) const {
    Words words = {"render", CSX600_SCENES_DIR "/cornell_box", "--size", "12x10", "--samples", "30000"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  /// Without what depends on the simulator's speed.
  Json statistics(const std::string& file) const {
    Json json = Json::parse(read(file));
    for (Json& part : json["parts"]) part.erase("simulator");
    return json;
  }
  bool has(const std::string& name) const {
    const Words all = files();
    return std::find(all.begin(), all.end(), name) != all.end();
  }
  void expect_refused(const Words& more, const std::string& part) {
    const CommandResult result = run(command(more));
    EXPECT_EQ(result.exit_code, 2);
    ASSERT_EQ(result.error_lines().size(), 1u) << result.error;
    EXPECT_NE(result.error.find(part), std::string::npos) << result.error;
  }
};

TEST_F(CheckpointCommand, AfterKillsGivesTheBitsOfARunWithoutOne) {
  for (const Words& how : {Words{"--native"}, Words{}}) {
    Words whole = how;
    whole.insert(whole.end(), {"--checkpoint", "whole", "--every", "1us", "--stats", "whole.json"});
    ASSERT_EQ(run(command(whole)).exit_code, 0);
    for (const int milliseconds : {700, 1300, 1900}) {
      Words killed = how;
      killed.insert(killed.end(), {"--checkpoint", "c", "--every", "1us"});
      if (has("c")) killed.emplace_back("--resume");
      const pid_t child = start(command(killed));
      std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
      kill(child, SIGKILL);
      finish(child);
    }
    Words last = how;
    last.insert(last.end(), {"--checkpoint", "c", "--stats", "c.json"});
    if (has("c")) last.emplace_back("--resume");
    ASSERT_EQ(run(command(last)).exit_code, 0);
    EXPECT_EQ(statistics("c.json"), statistics("whole.json"));
    for (const char* const file : {"whole", "c"}) std::filesystem::remove(directory() / file);
  }
}

TEST_F(CheckpointCommand, RefusesFilesOfNoUse) {
  ASSERT_EQ(run(command({"--native", "--checkpoint", "c"})).exit_code, 0);
  expect_refused({"--native", "--checkpoint", "c"}, "which exists");
  expect_refused({"--checkpoint", "c", "--resume"}, "a checkpoint of another render");
  expect_refused({"--native", "--checkpoint", "none", "--resume"}, "cannot be read");
  const std::string whole = read("c");
  for (const std::size_t size : {std::size_t{40}, std::size_t{70}, whole.size() / 2, whole.size() - 1}) {
    write("c", whole.substr(0, size));
    expect_refused({"--native", "--checkpoint", "c", "--resume"}, "cut off or changed");
  }
  std::string changed = whole;
  changed[whole.size() / 2] ^= 1;
  write("c", changed);
  expect_refused({"--native", "--checkpoint", "c", "--resume"}, "cut off or changed");
  write("c", "hello");
  expect_refused({"--native", "--checkpoint", "c", "--resume"}, "no checkpoint");
  expect_refused({"--resume"}, "--resume: found without --checkpoint");
  expect_refused({"--checkpoint", "d", "--target-error", "0.1"}, "allowed without them");
}

}  // namespace checkpoint_command_test
