#include <gtest/gtest.h>
#include <unistd.h>

#include <set>
#include <sstream>

#include "model/config/chip_file.hpp"
#include "model/config/chip_presets.hpp"
#include "tests/support/chip_config_support.hpp"

namespace model {
namespace chip_file_test {

TEST(EffectiveToml, RoundTripsEveryPreset) {
  for (const std::string& name : preset_names()) {
    const ChipConfig config = load_chip(name);
    const TomlFile file(effective_toml(config));
    const ChipConfig read = load_chip(file.path());
    EXPECT_TRUE(differences(config, read).empty()) << name;
    EXPECT_EQ(effective_toml(read), effective_toml(config)) << name;
  }
}

TEST(EffectiveToml, RoundTripsAChipInWhichEveryParameterWasChanged) {
  ChipConfig config = preset("g80_like");
  for (const ParameterInfo& parameter : parameter_table())
    parameter.write(config, other_values(parameter).back());
  config.poly.cycles.fill(1.0 / 3.0);
  config.chip.clock_hz = 210000000.00000003;
  config.control.cache_line_bytes = 8;
  config.clear_connect = {1, 8, 3, 5, 24};
  config.on_chip_sram = {2048, std::uint64_t{1} << 50, 7, 3, 9};
  config.chip.arrays = 1;
  config.search_unit = {3, 5, 7, 11, 13, 2, 4, 192, 8, 3, 6, 4096, std::uint64_t{1} << 51, 24, 5};
  config.ddr.page_hit_cycles = 0;
  config.ddr.banks = 1;
  config.ddr.page_bytes = 64;
  config.ddr.size_bytes = std::uint64_t{64} << 30;
  config.ddr.refresh_cycles = 0;
  ASSERT_NO_THROW(validate(config));
  const TomlFile file(effective_toml(config));
  EXPECT_TRUE(differences(load_chip(file.path()), config).empty());
}

TEST(EffectiveToml, ChangingAKeyChangesThatLineOnly) {
  const auto lines = [](const ChipConfig& config) {
    std::vector<std::string> result;
    std::istringstream text(effective_toml(config));
    for (std::string line; std::getline(text, line);) result.push_back(line);
    return result;
  };
  const std::vector<std::string> before = lines(default_chip_config());
  std::set<std::size_t> changed_lines;
  for (const ParameterInfo& parameter : parameter_table()) {
    ChipConfig config = default_chip_config();
    parameter.write(config, other_values(parameter).front());
    const std::vector<std::string> after = lines(config);
    ASSERT_EQ(after.size(), before.size());
    std::vector<std::size_t> changed;
    for (std::size_t i = 0; i < before.size(); ++i) {
      if (after[i] != before[i]) changed.push_back(i);
    }
    ASSERT_EQ(changed.size(), 1U) << parameter.key;
    EXPECT_EQ(before[changed[0]].rfind(parameter.key.substr(parameter.key.rfind('.') + 1) + " = ", 0), 0U);
    EXPECT_TRUE(changed_lines.insert(changed[0]).second) << parameter.key;
  }
}

TEST(LoadChip, FileOverridesItsPresetAndSetOverridesTheFile) {
  const TomlFile file(
      "chip.pes = 64\npreset = 'csx700'\n[pio]\nsetup_cycles = 77\nconsolidate_equal_addresses = true\n"
      "arbitration = 'strict_fifo'\n[poly.cycles]\nfp64_add = 3\nfp64_mul = 2.5\n");
  ChipConfig config = load_chip(file.path());
  EXPECT_EQ(config.preset, "csx700");
  EXPECT_EQ(config.chip.pes, 64);           // the preset's 192 is overridden, wherever `preset` stands
  EXPECT_EQ(config.chip.clock_hz, 250e6);   // from the preset
  EXPECT_EQ(config.poly.sram_bytes, 6144);  // from the table
  EXPECT_EQ(config.pio.setup_cycles, 77);
  EXPECT_TRUE(config.pio.consolidate_equal_addresses);
  EXPECT_EQ(config.pio.arbitration, PioArbitration::strict_fifo);
  EXPECT_EQ(config.poly.cycles[std::size_t(cn::InstructionClass::fp64_add)], 3.0);
  EXPECT_EQ(config.poly.cycles[std::size_t(cn::InstructionClass::fp64_mul)], 2.5);
  set_parameter(config, "pio.setup_cycles", "99", "--set");
  EXPECT_EQ(config.pio.setup_cycles, 99);
}

TEST(LoadChip, EmptyFileIsTheDefaultChip) {
  const TomlFile file("");
  EXPECT_TRUE(differences(load_chip(file.path()), default_chip_config()).empty());
}

TEST(LoadChip, ErrorsNameFileLineKeyFoundAndAllowed) {
  EXPECT_EQ(load_error("[pio]\n\nsetup_cycle = 3\n"),
            "FILE:3: unknown parameter 'pio.setup_cycle'; nearest known: 'pio.setup_cycles'; allowed: the "
            "keys listed "
            "by 'csx600 params'");
  EXPECT_EQ(load_error("[pio]\nsetup_cycles = -1\n"),
            "FILE:2: pio.setup_cycles: found '-1'; allowed: an integer from 0 to 1000000");
  EXPECT_EQ(load_error("# chip\n[chip]\npes = 96.0\n"),
            "FILE:3: chip.pes: found 'real 96'; allowed: an integer from 8 to 1024, a multiple of 8");
  EXPECT_EQ(load_error("[chip]\npes = '96'\n"),
            "FILE:2: chip.pes: found 'string 96'; allowed: an integer from 8 to 1024, a multiple of 8");
  EXPECT_EQ(load_error("[chip]\npes = [96]\n"),
            "FILE:2: chip.pes: found 'an array'; allowed: an integer from 8 to 1024, a multiple of 8");
  EXPECT_EQ(load_error("[chip.pes]\nvalue = 96\n"),
            "FILE:1: chip.pes: found 'a table'; allowed: an integer from 8 to 1024, a multiple of 8");
  EXPECT_EQ(load_error("[chip]\npes = 2024-01-01\n"),
            "FILE:2: chip.pes: found '2024-01-01'; allowed: an integer from 8 to 1024, a multiple of 8");
  EXPECT_EQ(load_error("[chip]\nclock_hz = nan\n"),
            "FILE:2: chip.clock_hz: found 'nan'; allowed: a number from 1000000 to 10000000000");
  EXPECT_EQ(load_error("[pio]\nconsolidate_equal_addresses = 1\n"),
            "FILE:2: pio.consolidate_equal_addresses: found 'integer 1'; allowed: true or false");
  EXPECT_EQ(load_error("[pio]\narbitration = 'fifo'\n")
                .rfind("FILE:2: pio.arbitration: found 'fifo'; allowed: one of", 0),
            0U);
  EXPECT_EQ(load_error("\npio = 3\n"), "FILE:2: pio: found 3; allowed: a table of parameters");
  EXPECT_EQ(load_error("preset = 3\n"), "FILE:1: preset: found 3; allowed: a string");
  EXPECT_EQ(load_error("\n\n[pi]\n").rfind("FILE:3: unknown parameter 'pi'; nearest known: ", 0), 0U);
  EXPECT_EQ(load_error("[poly.cycles]\nfp128_add = 1\n")
                .rfind("FILE:2: unknown parameter 'poly.cycles.fp128_add'", 0),
            0U);
  EXPECT_EQ(load_error("[ddr]\nbanks = 3\n"),
            "FILE: ddr.size_bytes: found '536870912'; allowed: a multiple of ddr.banks (3) times "
            "ddr.page_bytes (512)");
}

TEST(LoadChip, BrokenTomlNamesTheLine) {
  EXPECT_EQ(load_error("[chip]\npes = 96\nclock_hz = \n").rfind("FILE:3: not TOML: ", 0), 0U);
  EXPECT_EQ(load_error("[chip]\npes = 96\npes = 64\n").rfind("FILE:3: not TOML: ", 0), 0U);
}

TEST(LoadChip, MissingFileAndDirectory) {
  EXPECT_EQ(error_of([] { load_chip("/no/such/chip.toml"); }),
            "/no/such/chip.toml: cannot be read (No such file or directory); allowed: a readable TOML file");
  const std::string directory = testing::TempDir() + "chip_file_" + std::to_string(getpid()) + ".toml";
  std::filesystem::create_directory(directory);
  EXPECT_EQ(error_of([&] { load_chip(directory); }),
            directory + ": found a directory; allowed: a readable TOML file");
  std::filesystem::remove(directory);
}

}  // namespace chip_file_test
}  // namespace model
