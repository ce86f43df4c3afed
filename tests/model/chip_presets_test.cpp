#include <gtest/gtest.h>

#include <set>

#include "model/config/chip_presets.hpp"
#include "tests/support/chip_config_support.hpp"

namespace model {
namespace chip_presets_test {

TEST(Presets, AreTheFiveThatAreDocumented) {
  EXPECT_EQ(preset_names(),
            (std::vector<std::string>{"csx600", "csx600_250mhz", "csx700", "g80_like", "paper"}));
  EXPECT_TRUE(differences(preset("csx600"), default_chip_config()).empty());
  EXPECT_EQ(preset("csx600_250mhz").chip.clock_hz, 250e6);
  EXPECT_EQ(preset("csx700").chip.arrays * preset("csx700").chip.pes, 192);
  EXPECT_EQ(preset("csx700").ddr.size_bytes, std::uint64_t{2} << 30);
  EXPECT_EQ(preset("g80_like").chip.pes, 32);
  EXPECT_EQ(preset("paper").chip.pes, 96);
  EXPECT_EQ(preset("paper").chip.clock_hz, 210e6);
}

TEST(Presets, DdrKeepsItsTimesWhenTheClockChanges) {
  for (const std::string& name : preset_names()) {
    SCOPED_TRACE(name);
    const ChipConfig config = preset(name);
    EXPECT_NEAR(config.ddr.refresh_interval_cycles / config.chip.clock_hz, 7.8e-6, 1 / config.chip.clock_hz);
    EXPECT_GE(config.ddr.refresh_cycles / config.chip.clock_hz, 105e-9);
    EXPECT_LE(config.ddr.refresh_cycles / config.chip.clock_hz, 127.5e-9 + 1 / config.chip.clock_hz);
    EXPECT_NEAR(config.host.latency_cycles / config.chip.clock_hz, 10e-6, 1e-9);
  }
}

TEST(Presets, ChangeWhatTheyListAndGiveAReason) {
  for (const Preset& listed : preset_table()) {
    SCOPED_TRACE(listed.name);
    const ChipConfig config = preset(listed.name);
    EXPECT_EQ(config.preset, listed.name);
    EXPECT_FALSE(listed.summary.empty());
    std::set<std::string> keys;
    for (const PresetOverride& set : listed.overrides) {
      EXPECT_EQ(parameter_text(config, set.key), set.value) << set.key;
      EXPECT_GE(set.why.size(), 8U) << set.key;
      EXPECT_TRUE(keys.insert(std::string(set.key)).second) << set.key << " twice";
    }
    ChipConfig unnamed = config;
    unnamed.preset = "csx600";
    for (const std::string& key : differences(unnamed, default_chip_config()))
      EXPECT_EQ(keys.count(key), 1U) << key;
  }
}

TEST(Presets, UnknownNameListsThem) {
  EXPECT_EQ(error_of([] { preset("csx800"); }),
            "unknown preset 'csx800'; allowed: csx600, csx600_250mhz, csx700, g80_like, paper");
  EXPECT_EQ(error_of([] { load_chip("csx800"); }),
            "unknown preset 'csx800'; allowed: csx600, csx600_250mhz, csx700, g80_like, paper, or a file "
            "whose name "
            "ends in .toml");
  EXPECT_EQ(load_error("\npreset = 'csx800'\n"),
            "FILE:2: unknown preset 'csx800'; allowed: csx600, csx600_250mhz, csx700, g80_like, paper");
}

}  // namespace chip_presets_test
}  // namespace model
