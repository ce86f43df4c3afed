// csx600 inject and render --fault, as their users start them.

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/command_line.hpp"

namespace inject_command_test {

using test_support::CommandResult;
using Words = std::vector<std::string>;

const std::string kScene = CSX600_SCENES_DIR "/cornell_box";

class InjectCommand : public test_support::CommandLineFixture {
 protected:
  static Words with(Words command, const Words& more) {
    command.insert(command.end(), more.begin(), more.end());
    return command;
  }
  CommandResult render(const Words& more) {
    return run(with({"render", kScene, "--size", "8x6", "--samples", "1"}, more));
  }
  CommandResult inject(const Words& more) {
    return run(with({"inject", kScene, "--size", "8x6", "--samples", "1", "-o", "out"}, more));
  }
  void expect_error(const CommandResult& result, int exit_code, const Words& parts) {
    EXPECT_EQ(result.exit_code, exit_code) << result.error;
    EXPECT_EQ(result.error_lines().size(), 1u) << result.error;
    for (const std::string& part : parts)
      EXPECT_NE(result.error.find(part), std::string::npos) << part << " in: " << result.error;
  }
  /// The runs of the campaign, sorted: they end in any order.
  std::string sorted_runs() {
    std::string text = read("out/faults.jsonl");
    std::vector<std::string> lines;
    for (std::size_t begin = 0, end = 0; (end = text.find('\n', begin)) != std::string::npos; begin = end + 1)
      lines.push_back(text.substr(begin, end - begin));
    std::sort(lines.begin(), lines.end());
    std::string sorted;
    for (const std::string& line : lines) sorted += line + "\n";
    return sorted;
  }
};

TEST_F(InjectCommand, ALostCompletionEndsTheRenderAndNamesWhoWaits) {
  expect_error(render({"--fault", "pio_lost,cycle=20000"}), 1,
               {"deadlock", "the control unit waits for semaphore"});
}

TEST_F(InjectCommand, EccKeepsTheImageAndIsCounted) {
  ASSERT_EQ(render({"--exr", "a.exr"}).exit_code, 0);
  const CommandResult result = render({"--exr", "b.exr", "--fault", "ddr,cycle=0,address=128,bit=3"});
  EXPECT_EQ(result.exit_code, 0) << result.error;
  EXPECT_NE(result.out.find("1 faults injected, ECC corrected 1 words"), std::string::npos) << result.out;
  EXPECT_EQ(read("a.exr"), read("b.exr"));
}

TEST_F(InjectCommand, TheWatchdogEndsARender) {
  expect_error(render({"--set", "chip.watchdog_cycles=1000"}), 1, {"watchdog", "1000 cycles"});
}

TEST_F(InjectCommand, TheHazardCheckerNoticesADoubledCompletion) {
  EXPECT_EQ(render({"--fault", "pio_doubled,cycle=20000"}).exit_code, 0);
  EXPECT_EQ(render({"--check-hazards"}).exit_code, 0);
  EXPECT_EQ(render({"--check-hazards", "--fault", "pio_doubled,cycle=20000"}).exit_code, 1);
}

TEST_F(InjectCommand, FaultsAreCheckedBeforeTheRun) {
  expect_error(render({"--fault", "cosmic,cycle=1"}), 2, {"cosmic", "poly_sram, poly_register"});
  expect_error(render({"--fault", "ddr,cycle=1,bit=0"}), 2, {"address"});
  expect_error(render({"--fault", "ddr,cycle=1,address=0,bit=8"}), 2, {"bit", "'8'", "0 to 7"});
  expect_error(render({"--fault", "poly_sram,cycle=1,pe=96,address=0,bit=1"}), 2, {"pe", "below 96"});
  expect_error(render({"--fault", "pio_lost,cycle=1", "--native"}), 2, {"--fault", "--native"});
  expect_error(render({"--fault", "pio_lost,cycle=1", "--timing", "at"}), 2, {"--fault", "lt"});
  expect_error(render({"--fault", "pio_lost,cycle=1", "--set", "board.chips=2"}), 2, {"board.chips"});
  expect_error(inject({"--kinds", "ddr,cosmic"}), 2, {"cosmic"});
}

TEST_F(InjectCommand, CountsOneFaultARunAndRepeats) {
  const CommandResult whole = inject({"--count", "40", "--jobs", "2"});
  ASSERT_EQ(whole.exit_code, 0) << whole.error;
  EXPECT_NE(whole.out.find("40 runs with one fault each"), std::string::npos) << whole.out;
  const std::string runs = sorted_runs();
  EXPECT_EQ(std::count(runs.begin(), runs.end(), '\n'), 41);
  // Every eighth run loses a completion, of which each has a waiter.
  EXPECT_NE(read("out/faults.csv").find("pio_lost,5,0,0,0,0,0,5,0,0,1,"), std::string::npos)
      << read("out/faults.csv");
  const std::string table = read("out/faults.csv");
  std::filesystem::remove_all(directory() / "out");
  ASSERT_EQ(inject({"--count", "15", "--jobs", "1"}).exit_code, 0);
  const CommandResult rest = inject({"--count", "40", "--jobs", "1"});
  EXPECT_NE(rest.out.find("15 were there"), std::string::npos) << rest.out;
  EXPECT_EQ(sorted_runs(), runs);
  EXPECT_EQ(read("out/faults.csv"), table);
  expect_error(inject({"--count", "40", "--fault-seed", "2"}), 2, {"faults.jsonl:1", "another campaign"});
}

}  // namespace inject_command_test
