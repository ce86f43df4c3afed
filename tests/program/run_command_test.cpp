// csx600 run: plug-ins as a stranger starts them.

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/support/command_line.hpp"

namespace run_command_test {

using test_support::CommandResult;
using Words = std::vector<std::string>;

std::string plug_in(const std::string& name) {
  return std::string(CSX600_PLUG_INS) + "/lib" + name + ".so";
}

class RunCommand : public test_support::CommandLineFixture {
 protected:
  nlohmann::json statistics(Words arguments) {
    arguments.insert(arguments.begin(), {"run", "--stats", "run.json"});
    const CommandResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.error;
    return nlohmann::json::parse(read("run.json"));
  }
  void expect_error(Words arguments, int exit_code, const Words& parts) {
    arguments.insert(arguments.begin(), {"run", "--stats", "run.json"});
    const CommandResult result = run(arguments);
    EXPECT_EQ(result.exit_code, exit_code);
    const Words lines = result.error_lines();
    ASSERT_FALSE(lines.empty());
    for (const std::string& part : parts) EXPECT_NE(lines[0].find(part), std::string::npos) << lines[0];
    EXPECT_EQ(result.out, "");
    for (const std::string& file : files()) EXPECT_NE(file, "run.json");
  }
};

TEST_F(RunCommand, OptionsReachTheFirmwareAndTheStatistics) {
  const nlohmann::json json = statistics({plug_in("saxpy"), "--", "--blocks=3", "--a", "4.5"});
  EXPECT_EQ(json["firmware"]["name"], "saxpy");
  EXPECT_EQ(json["firmware"]["options"]["blocks"], 3);
  EXPECT_EQ(json["firmware"]["options"]["a"], 4.5);
  EXPECT_EQ(json["work"]["amount"], 3 * 96 * 16);
  // Each block loads x and y and saves y, 64 bytes a PE.
  EXPECT_EQ(json["chip"]["pio"]["bytes_mono_to_poly"], 3 * 2 * 96 * 64);
  EXPECT_EQ(json["chip"]["pio"]["bytes_poly_to_mono"], 3 * 96 * 64);
  EXPECT_EQ(json["chip"]["host_link"]["bytes_uploaded"], 3 * 2 * 96 * 64);
  EXPECT_EQ(json["chip"]["host_link"]["bytes_downloaded"], 3 * 96 * 64);
}

TEST_F(RunCommand, HazardCheckAndRepetitionChangeNoCycle) {
  const Words words = {plug_in("fft1d"), "--", "--batches", "4"};
  Words checked = words;
  checked.insert(checked.begin(), "--check-hazards");
  const nlohmann::json first = statistics(words);
  EXPECT_EQ(statistics(words)["chip"], first["chip"]);
  EXPECT_EQ(statistics(checked)["chip"], first["chip"]);
}

TEST_F(RunCommand, RunsNativelyAndApproximatelyTimed) {
  for (const Words& how : {Words{"--native"}, Words{"--timing", "at"}, Words{"--set", "chip.pes=64"}}) {
    Words words = how;
    words.insert(words.end(), {plug_in("fft1d"), "--", "--batches", "2"});
    EXPECT_TRUE(statistics(words).contains("chip_config"));
  }
}

TEST_F(RunCommand, ListsTheFirmwaresOptions) {
  const CommandResult result = run({"run", plug_in("saxpy"), "--", "--help"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_NE(result.out.find("--blocks 1..4096 [64]"), std::string::npos) << result.out;
}

TEST_F(RunCommand, RefusesWhatIsNoPlugInOfThisProgram) {
  write("text.so", "no library");
  expect_error({"nothing.so"}, 2, {"firmware: found 'nothing.so'"});
  expect_error({"."}, 2, {"firmware: found '.'", "shared library"});
  expect_error({"text.so"}, 2, {"text.so", "does not load as a shared library"});
  expect_error({plug_in("without_symbol")}, 2, {"has no symbol csx600_firmware"});
  expect_error({plug_in("other_version")}, 2, {"of version 0.0.1-000000000000, allowed is"});
}

TEST_F(RunCommand, ALibraryThatIsCutOffIsRefused) {
  std::filesystem::copy_file(plug_in("saxpy"), directory() / "cut.so");
  std::filesystem::resize_file(directory() / "cut.so", 3000);
  expect_error({"./cut.so"}, 2, {"firmware: found './cut.so'"});
}

TEST_F(RunCommand, FindsInstalledFirmwareByItsName) {
  expect_error({"dgem"}, 2,
               {"'dgem'", "dgemm, fft, monte_carlo, pio_sweep, stream", "did you mean 'dgemm'?"});
  for (const char* const name : {"dgemm", "fft", "monte_carlo", "pio_sweep", "stream"}) {
    Words words = {name};
    if (name == std::string("dgemm"))
      words.insert(words.end(), {"--", "--panels", "1", "--column_blocks", "1"});
    EXPECT_GT(statistics(words)["simulated_cycles"], 1000) << name;
  }
}

TEST_F(RunCommand, StatisticsAreComparedPrintedAndShown) {
  ASSERT_EQ(run({"run", plug_in("faults"), "--stats", "a.json"}).exit_code, 0);
  ASSERT_EQ(run({"run", plug_in("faults"), "--stats", "b.json", "--set", "pio.setup_cycles=0"}).exit_code, 0);
  EXPECT_EQ(run({"compare", "a.json", "a.json"}).exit_code, 0);
  const CommandResult moved = run({"compare", "a.json", "b.json"});
  EXPECT_EQ(moved.exit_code, 1);
  EXPECT_NE(moved.out.find("simulated_cycles"), std::string::npos) << moved.out;
  EXPECT_NE(run({"stats", "a.json"}).out.find("\nfirmware.counters.sum\n  value "), std::string::npos);
  EXPECT_NE(run({"stats", "--describe", "--firmware", plug_in("faults")})
                .out.find("firmware.counters.sum  -  of the numbers, doubled"),
            std::string::npos);
  EXPECT_EQ(run({"stats", "a.json", "--firmware", plug_in("faults")}).exit_code, 2);
  EXPECT_EQ(run({"report", "a.json", "-o", "a.html"}).exit_code, 0);
  nlohmann::json damaged = nlohmann::json::parse(read("a.json"));
  damaged["chip"].erase("ddr");
  write("damaged.json", damaged.dump());
  EXPECT_EQ(run({"stats", "damaged.json"}).exit_code, 2);
  damaged = nlohmann::json::parse(read("a.json"));
  damaged["firmware"]["counters"][0]["value"] = "many";
  write("damaged.json", damaged.dump());
  const CommandResult refused = run({"compare", "damaged.json", "a.json"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.error.find("firmware.counters.0.value"), std::string::npos) << refused.error;
}

TEST_F(RunCommand, RefusesOptions) {
  const std::string saxpy = plug_in("saxpy");
  expect_error({saxpy, "--", "--blocks", "0"}, 2, {"--blocks: found '0', allowed is 1..4096"});
  expect_error({saxpy, "--", "--blocks=4097"}, 2, {"--blocks: found '4097'"});
  expect_error({saxpy, "--", "--blocks=3x"}, 2, {"--blocks: found '3x'"});
  expect_error({saxpy, "--", "--a=nan"}, 2, {"--a: found 'nan'"});
  expect_error({saxpy, "--", "--blocks"}, 2, {"--blocks: found no value, allowed is 1..4096"});
  expect_error({saxpy, "--", "--size=3"}, 2, {"saxpy: found '--size', allowed is --blocks, --a"});
  expect_error({saxpy, "--", "blocks=3"}, 2, {"found 'blocks=3'"});
  expect_error({saxpy, "--", "--blocks=3", "--blocks", "3"}, 2,
               {"saxpy: --blocks: found twice, allowed is once"});
  expect_error({saxpy, "--", "--block=3"}, 2, {"did you mean '--blocks'?"});
  expect_error({saxpy, "--native", "--timing", "at"}, 2, {"--timing: found at with --native"});
  expect_error({plug_in("fft1d"), "--set", "chip.pes=100"}, 2, {"chip.pes"});
}

TEST_F(RunCommand, NamesTheFault) {
  const std::string faults = plug_in("faults");
  const auto expect_fault = [&](const char* number, int exit_code, const Words& parts) {
    expect_error({"--check-hazards", faults, "--", "--fault", number}, exit_code, parts);
  };
  EXPECT_EQ(run({"run", "--check-hazards", faults}).exit_code, 0);
  expect_fault("1", 1, {"faults: number 1 is wrong"});
  expect_fault("2", 1, {"twice", "number"});
  expect_fault("3", 1, {"copied"});
  expect_fault("4", 2, {"too much"});
  expect_fault("5", 2, {"faults: fault: found 5, allowed is anything else"});
  expect_error({faults, "--set", "ddr.size_bytes=1048576", "--", "--fault=6"}, 2,
               {"faults: buffers need 8388608 bytes of mono memory, ddr.size_bytes allows 1048576"});
  expect_fault("8", 1, {"faults: a kernel has thrown"});
  expect_fault("9", 1, {"faults: found that it throws what is no std::exception"});
  expect_fault("10", 1, {"kernel 'twice' writes poly bytes 6144..6151 of PE 0, whose SRAM has 6144"});
  expect_fault("11", 1, {"faults: crashed"});
  expect_error({"--time-limit", "1", faults, "--", "--fault", "7"}, 1,
               {"--time-limit: the run has not ended after 1 s"});
  const CommandResult printing = run({"run", faults, "--", "--fault=12"});
  EXPECT_EQ(printing.exit_code, 0);
  EXPECT_NE(printing.out.find("printed by a kernel"), std::string::npos) << printing.out;
  // Without the checker, a race shows in the results or not at all.
  EXPECT_EQ(run({"run", "--native", faults, "--", "--fault", "3"}).exit_code, 1);
}

}  // namespace run_command_test
