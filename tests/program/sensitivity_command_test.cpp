// csx600 sensitivity, as its users start it.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/command_line.hpp"

namespace sensitivity_command_test {

using Json = nlohmann::json;
using test_support::CommandResult;
using Words = std::vector<std::string>;

const std::string kScene = CSX600_SCENES_DIR "/cornell_box";

class SensitivityCommand : public test_support::CommandLineFixture {
 protected:
  Json study(Words arguments) {
    const Words all = {"--stats", "study.json", "--csv", "study.csv"};
    arguments.insert(arguments.begin(), "sensitivity");
    arguments.insert(arguments.end(), all.begin(), all.end());
    result = run(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.error;
    return Json::parse(read("study.json"));
  }
  /// The run of a study in which the parameter has that value.
  static Json changed(const Json& study, const std::string& key, const std::string& value) {
    for (const Json& parameter : study["sensitivity"]["parameters"])
      if (parameter["name"] == key)
        for (const Json& one : parameter["runs"])
          if (one["value"] == value) return one;
    ADD_FAILURE() << "no " << key << " = " << value;
    return {};
  }
  /// What `render` says of the same chip.
  Json rendered(const Words& settings) {
    Words arguments = {"render", kScene, "--size", "12x12", "--samples", "2", "--stats", "render.json"};
    for (const std::string& setting : settings) arguments.insert(arguments.end(), {"--set", setting});
    EXPECT_EQ(run(arguments).exit_code, 0);
    return Json::parse(read("render.json"));
  }
  void expect_error(Words arguments, const Words& parts) {
    arguments.insert(arguments.begin(), "sensitivity");
    const CommandResult wrong = run(arguments);
    EXPECT_EQ(wrong.exit_code, 2) << wrong.error;
    ASSERT_EQ(wrong.error_lines().size(), 1u) << wrong.error;
    for (const std::string& part : parts)
      EXPECT_NE(wrong.error.find(part), std::string::npos) << part << " in: " << wrong.error;
  }

  CommandResult result;
};

TEST_F(SensitivityCommand, EachChangedRunTakesWhatRenderTakesOnThatChip) {
  const Json found = study({kScene, "--size", "12x12", "--samples", "2", "--only", "pio.", "--only", "chip.",
                            "--only", "energy.pe_clock"});
  EXPECT_EQ(found["simulated_cycles"], rendered({})["simulated_cycles"]);
  const std::vector<std::pair<std::string, std::string>> some = {{"pio.setup_cycles", "135"},
                                                                 {"pio.setup_cycles", "165"},
                                                                 {"pio.arbitration", "queue_per_direction"},
                                                                 {"chip.pes", "104"},
                                                                 {"chip.arrays", "2"},
                                                                 {"chip.clock_hz", "231000000"},
                                                                 {"energy.pe_clock_picojoules", "11"}};
  for (const auto& [key, value] : some) {
    const Json expected = rendered({key + "=" + value});
    const Json one = changed(found, key, value);
    EXPECT_EQ(one["cycles"], expected["simulated_cycles"].get<double>()) << key;
    EXPECT_EQ(one["joules"], expected["chip"]["energy"]["joules"]) << key;
    EXPECT_NEAR(one["time_change"],
                expected["simulated_seconds"].get<double>() / found["simulated_seconds"].get<double>() - 1,
                1e-12)
        << key;
  }
  EXPECT_NE(result.out.find("Helps most, time: "), std::string::npos) << result.out;
}

TEST_F(SensitivityCommand, LargestEffectsComeFirstAndSmallOnesAreCounted) {
  const Json found = study({kScene, "--size", "12x12", "--samples", "1"});
  double last = 1e9;
  for (const Json& parameter : found["sensitivity"]["parameters"]) {
    double effect = 0;
    for (const Json& one : parameter["runs"])
      if (one.contains("time_change")) effect = std::max(effect, std::abs(one["time_change"].get<double>()));
    EXPECT_LE(effect, last) << parameter["name"];
    last = effect;
  }
  EXPECT_EQ(last, 0);  // energy parameters change no time
  std::istringstream csv(read("study.csv"));
  std::string line;
  std::size_t lines = 0;
  while (std::getline(csv, line)) ++lines;
  std::size_t runs = 0;
  for (const Json& parameter : found["sensitivity"]["parameters"]) runs += parameter["runs"].size();
  EXPECT_EQ(lines, runs + 1);
  const Json by_energy = study({kScene, "--size", "12x12", "--samples", "1", "--order", "energy"});
  EXPECT_EQ(by_energy["sensitivity"]["order"], "energy");
  EXPECT_NE(by_energy["sensitivity"]["parameters"][0]["runs"][0]["energy_change"], 0);
}

TEST_F(SensitivityCommand, ARunIsMadeAgainFromItsStatistics) {
  const Json render = rendered({"ddr.page_hit_cycles=50", "pio.queue_depth=2"});
  const Json found = study({"render.json", "--only", "pio.queue_depth"});
  EXPECT_EQ(found["simulated_cycles"], render["simulated_cycles"]);
  EXPECT_EQ(found["image_sha256"], render["image_sha256"]);
  EXPECT_EQ(found["chip_config"], render["chip_config"]);
  EXPECT_EQ(found["firmware"], render["firmware"]);
  EXPECT_EQ(result.error, "");
  Json other = render;
  other["simulated_cycles"] = 12345;
  write("other.json", other.dump());
  study({"other.json", "--only", "pio.queue_depth"});
  EXPECT_NE(result.error.find("other.json: says 12345 cycles"), std::string::npos) << result.error;
}

TEST_F(SensitivityCommand, OfAFirmwareFromALibrary) {
  const Json found = study({"stream", "--only", "pio.bytes_per_cycle"});
  EXPECT_EQ(found["firmware"]["name"], "stream");
  EXPECT_LT(changed(found, "pio.bytes_per_cycle", "9")["time_change"], 0);
  EXPECT_GT(changed(found, "pio.bytes_per_cycle", "7")["time_change"], 0);
  EXPECT_EQ(found["sensitivity"]["replayed"], 0);  // it has several threads
  EXPECT_EQ(study({"fft", "--only", "ddr.bytes_per_cycle"})["sensitivity"]["replayed"], 2);
}

TEST_F(SensitivityCommand, AChipThatCannotRunItIsARowAndNoEnd) {
  const Json found =
      study({kScene, "--size", "8x8", "--samples", "1", "--only", "poly.sram_bytes", "--by", "80"});
  EXPECT_NE(changed(found, "poly.sram_bytes", "1232")["error"].get<std::string>().find("poly SRAM overflow"),
            std::string::npos);
  EXPECT_NE(result.out.find("1 changed chips cannot run it"), std::string::npos) << result.out;
}

TEST_F(SensitivityCommand, WrongUses) {
  expect_error({kScene, "--only", "nothing"}, {"--only", "csx600 params"});
  expect_error({kScene, "--set", "pio.setup_cycles"}, {"--set", "key=value"});
  expect_error({kScene, "--set", "firmware.n=99"}, {"firmware.n", "99"});
  expect_error({kScene, "--size", "0x0"}, {"--size", "0x0"});
  expect_error({kScene, "--samples", "none"}, {"--samples", "none"});
  expect_error({kScene, "--by", "0"}, {"--by", "0"});
  expect_error({"none.json"}, {"none.json", "cannot be read"});
  expect_error({"no_scene"}, {"no_scene"});
  Json render = rendered({});
  render["importance"] = "map.exr";
  write("render.json", render.dump());
  expect_error({"render.json"}, {"render.json", "importance", "map.exr"});
  expect_error({"render.json", "--stats", "render.json"}, {"--stats", "render.json"});
}

}  // namespace sensitivity_command_test
