#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "model/config/chip_presets.hpp"
#include "model/config/parameter_report.hpp"

namespace model {
namespace parameter_report_test {

TEST(ParameterReport, JsonHoldsEveryParameterWithItsTypedValue) {
  ChipConfig config = preset("csx700");
  set_parameter(config, "pio.queue_depth", "3", "--set");
  set_parameter(config, "chip.pes", "64", "--set");
  const nlohmann::json report = nlohmann::json::parse(parameter_json_report(config));
  ASSERT_TRUE(report.is_array());
  ASSERT_EQ(report.size(), parameter_table().size());
  std::map<std::string, nlohmann::json> by_key;
  for (std::size_t i = 0; i < report.size(); ++i) {
    const ParameterInfo& parameter = parameter_table()[i];
    EXPECT_EQ(report[i]["key"], parameter.key);
    EXPECT_EQ(report[i]["unit"], parameter.unit);
    EXPECT_EQ(report[i]["meaning"], parameter.meaning);
    EXPECT_EQ(report[i]["allowed"], allowed_text(parameter));
    by_key[parameter.key] = report[i];
  }
  EXPECT_EQ(by_key["chip.clock_hz"]["value"], 250e6);
  EXPECT_EQ(by_key["chip.clock_hz"]["default"], 210e6);
  EXPECT_EQ(by_key["chip.clock_hz"]["confidence"], "inferred");
  EXPECT_NE(by_key["chip.clock_hz"]["preset_reason"].get<std::string>().find("96 GFLOPS"), std::string::npos);
  EXPECT_TRUE(by_key["pio.queue_depth"]["value"].is_number_integer());
  EXPECT_EQ(by_key["pio.queue_depth"]["value"], 3);
  EXPECT_EQ(by_key["pio.queue_depth"]["confidence"], "user");
  EXPECT_EQ(by_key["chip.pes"]["confidence"], "user");  // neither the preset's value nor the default
  EXPECT_FALSE(by_key["chip.pes"].contains("preset_reason"));
  EXPECT_EQ(by_key["poly.sram_bytes"]["confidence"], "vendor");
  EXPECT_EQ(by_key["pio.arbitration"]["value"], "reads_overtake_writes");
  EXPECT_EQ(by_key["pio.consolidate_equal_addresses"]["value"], false);
}

TEST(ParameterReport, TextHasALineForEveryParameter) {
  ChipConfig config = preset("paper");
  set_parameter(config, "ddr.banks", "8", "--set");
  std::istringstream text(parameter_text_report(config));
  std::string line;
  std::getline(text, line);
  std::istringstream header(line);
  for (const char* column : {"key", "value", "unit", "confidence", "meaning"}) {
    std::string word;
    header >> word;
    EXPECT_EQ(word, column);
  }
  const std::size_t meaning_at = line.find("meaning");
  for (const ParameterInfo& parameter : parameter_table()) {
    ASSERT_TRUE(std::getline(text, line));
    std::istringstream words(line);
    std::string key, value, unit, confidence;
    words >> key >> value >> unit >> confidence;
    EXPECT_EQ(key, parameter.key);
    EXPECT_EQ(value, parameter_text(config, parameter.key));
    EXPECT_EQ(unit, parameter.unit);
    EXPECT_EQ(line.compare(meaning_at, parameter.meaning.size(), parameter.meaning), 0) << line;
    if (key == "ddr.banks") {
      EXPECT_EQ(confidence, "user");
    }
    if (key == "chip.pes") {
      EXPECT_NE(line.find("| paper: the paper does not say"), std::string::npos);
    }
  }
}

TEST(ParameterReport, PresetsAreListedWithTheirReasons) {
  const std::string report = preset_text_report();
  for (const Preset& preset : preset_table()) {
    EXPECT_NE(report.find(std::string(preset.name) + ": " + std::string(preset.summary)), std::string::npos);
    for (const PresetOverride& set : preset.overrides)
      EXPECT_NE(report.find(set.why), std::string::npos) << set.key;
  }
}

}  // namespace parameter_report_test
}  // namespace model
