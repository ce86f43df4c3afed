#include "testbench/run/technology.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "model/config/chip_parameters.hpp"
#include "testbench/run/area.hpp"
#include "testbench/run/energy.hpp"

namespace technology_test {

using testbench::ChipStatistics;
using testbench::Energy;

/// A run that reads and writes words of SRAM and computes, on a chip with so much SRAM a PE.
ChipStatistics run_with(int poly_sram_bytes) {
  ChipStatistics run;
  run.config = model::default_chip_config();
  run.config.poly.sram_bytes = poly_sram_bytes;
  run.total_cycles = 420000;  // 2 ms
  run.all_kernels.executed.by_class[std::size_t(cn::InstructionClass::sram)] = 3000000;
  run.all_kernels.executed.by_class[std::size_t(cn::InstructionClass::fp64_mul)] = 1000000;
  run.poly_sram.words_in = 20000;
  run.ddr.bytes_read = 160000;
  return run;
}

double joules_of(const ChipStatistics& run, const std::string& cause) {
  for (const Energy::Cause& of : testbench::energy_of(run).causes)
    if (of.name == cause) return of.joules;
  ADD_FAILURE() << cause;
  return 0;
}

double mm2_of(const model::ChipConfig& config) {
  return testbench::area_of(config).mm2();
}

// Energies in pJ (read + write) / 2 of CACTI 7.0's macros, 8 bytes an access, itrs-hp.
TEST(Sram, AccessesCostWhatMacrosOfTheirSizeCost) {
  struct Macro {
    double bytes, read_pj, write_pj;
  };
  const double of_130nm = (34.4 + 43.5) / 2;
  for (const Macro& macro : {Macro{2048, 12.7, 34.5}, Macro{8192, 37.1, 49.5}, Macro{32768, 95.2, 95.9},
                             Macro{131072, 212, 163}, Macro{1048576, 565, 415}}) {
    const double found = of_130nm * testbench::sram_access_factor(macro.bytes, 6144);
    EXPECT_NEAR(found / ((macro.read_pj + macro.write_pj) / 2), 1, 0.065)
        << macro.bytes << " bytes at 130 nm";
  }
  const double of_45nm = (5.43 + 6.42) / 2;
  for (const Macro& macro : {Macro{2048, 2.67, 3.98}, Macro{32768, 17, 14.5}, Macro{1048576, 77.2, 63.9}}) {
    const double found = of_45nm * testbench::sram_access_factor(macro.bytes, 6144);
    EXPECT_NEAR(found / ((macro.read_pj + macro.write_pj) / 2), 1, 0.135) << macro.bytes << " bytes at 45 nm";
  }
}

TEST(Sram, EnergyLeakageAndAreaGrowWithItsSize) {
  const ChipStatistics small = run_with(6144);
  const ChipStatistics large = run_with(65536);
  EXPECT_NEAR(joules_of(large, "poly_sram") / joules_of(small, "poly_sram"), std::sqrt(64.0 / 6), 1e-12);
  EXPECT_NEAR(joules_of(large, "leakage") - joules_of(small, "leakage"), 96 * 58 * 0.00027 * 0.002, 1e-12);
  EXPECT_EQ(joules_of(large, "fp64_mul"), joules_of(small, "fp64_mul"));
  EXPECT_EQ(joules_of(large, "ddr_read"), joules_of(small, "ddr_read"));
  EXPECT_NEAR(mm2_of(large.config) - mm2_of(small.config), 96 * 58 * 0.03, 1e-9);
  double joules = 0;
  double mm2 = 0;
  for (int bytes = 2048; bytes <= 262144; bytes *= 2) {
    const ChipStatistics run = run_with(bytes);
    EXPECT_GT(testbench::energy_of(run).joules(), joules) << bytes;
    EXPECT_GT(mm2_of(run.config), mm2) << bytes;
    joules = testbench::energy_of(run).joules();
    mm2 = mm2_of(run.config);
  }
}

TEST(Sram, OfTheChipFollowsItsSizeToo) {
  ChipStatistics run = run_with(6144);
  run.on_chip_sram.accesses = 100;
  run.on_chip_sram.bytes_read = 6400;
  run.config.on_chip_sram.size_bytes = 131072;
  const double joules = joules_of(run, "on_chip_sram");
  const double leakage = joules_of(run, "leakage");
  const double mm2 = mm2_of(run.config);
  EXPECT_NEAR(joules, 15.93e-12 * 4.75 * 6400, 1e-15);
  run.config.on_chip_sram.size_bytes = 524288;
  EXPECT_NEAR(joules_of(run, "on_chip_sram"), 2 * joules, 1e-15);
  EXPECT_NEAR(joules_of(run, "leakage") - leakage, 384 * 0.00027 * 0.002, 1e-12);
  EXPECT_NEAR(mm2_of(run.config) - mm2, 384 * 0.03, 1e-9);
}

// By hand from the polynomials: 130 nm at 1.2 V 5.17944, at 0.8 V 2.12624; 45 nm at 1.0 V 1.0177; 65 nm at
// 1.1 V 1.68075; 7 nm at 0.7 V 0.047815.
TEST(ProcessNodes, ScaleEnergyLeakageAndAreaByTheTable) {
  const auto at = [](int nm, double volts) { return testbench::technology_factors({nm, volts}); };
  EXPECT_EQ(at(130, 1.2).energy, 1.0);
  EXPECT_EQ(at(130, 1.2).leakage, 1.0);
  EXPECT_EQ(at(130, 1.2).area, 1.0);
  EXPECT_NEAR(at(130, 0.8).energy, 2.12624 / 5.17944, 1e-9);
  EXPECT_NEAR(at(130, 0.8).leakage, 0.8 / 1.2, 1e-12);
  EXPECT_NEAR(at(45, 1.0).energy, 1.0177 / 5.17944, 1e-9);
  EXPECT_NEAR(at(45, 1.0).leakage, 7.51 / 2.16, 1e-9);
  EXPECT_EQ(at(45, 1.0).area, 0.16);
  EXPECT_NEAR(at(65, 1.1).energy, 1.68075 / 5.17944, 1e-9);
  EXPECT_NEAR(at(7, 0.7).energy, 0.047815 / 5.17944, 1e-9);
  EXPECT_EQ(at(7, 0.7).area, 0.0092);
  // Between two rows: (28 / 32)^p with p from the rows of 32 and 20 nm.
  const double power = std::log(0.072 / 0.033) / std::log(32.0 / 20);
  EXPECT_NEAR(at(28, 0.9).area, 0.072 * std::pow(28.0 / 32, power), 1e-12);
}

TEST(ProcessNodes, SmallerOnesNeedLessEnergyAndArea) {
  for (int nm = 130; nm > 7; --nm) {
    const testbench::TechnologyFactors larger = testbench::technology_factors({nm, 0.8});
    const testbench::TechnologyFactors smaller = testbench::technology_factors({nm - 1, 0.8});
    EXPECT_LT(smaller.energy, larger.energy) << nm;
    EXPECT_LT(smaller.area, larger.area) << nm;
  }
}

TEST(ProcessNodes, ScaleTheChipAndNotItsMemory) {
  ChipStatistics run = run_with(6144);
  const ChipStatistics original = run;
  run.config.technology = {45, 1.0};
  for (const char* cause : {"fp64_mul", "poly_sram", "pe_clock"})
    EXPECT_NEAR(joules_of(run, cause) / joules_of(original, cause), 1.0177 / 5.17944, 1e-9) << cause;
  EXPECT_EQ(joules_of(run, "ddr_read"), joules_of(original, "ddr_read"));
  EXPECT_NEAR(mm2_of(run.config), 0.16 * (96 * 0.8 + 80), 1e-9);
}

TEST(TechnologyNotes, NameWhatLiesOutsideTheTables) {
  model::ChipConfig config = model::default_chip_config();
  EXPECT_TRUE(testbench::technology_notes(config).empty());
  config.technology = {14, 1.2};
  config.poly.sram_bytes = 1024;
  config.on_chip_sram.size_bytes = 2097152;
  const std::vector<std::string> notes = testbench::technology_notes(config);
  ASSERT_EQ(notes.size(), 4u);
  EXPECT_EQ(notes[0], "technology.voltage_v 1.2 is far from the 0.80 V usual at 14 nm");
  EXPECT_EQ(notes[1],
            "technology.node_nm 14 is below 20 nm, where leakage is no longer known: that of 22 nm is used");
  EXPECT_EQ(notes[2],
            "poly.sram_bytes 1024 is outside 2048 to 1048576 bytes, for which energy of SRAM is fitted");
  EXPECT_EQ(notes[3],
            "on_chip_sram.size_bytes 2097152 is outside 2048 to 1048576 bytes, for which energy of SRAM is "
            "fitted");
  config = model::default_chip_config();
  config.technology = {45, 1.0};
  config.poly.sram_bytes = 65536;
  EXPECT_TRUE(testbench::technology_notes(config).empty());
}

TEST(TechnologyParameters, BadValuesGetOneLine) {
  model::ChipConfig config = model::default_chip_config();
  const auto refusal = [&](const char* key, const char* value) -> std::string {
    try {
      model::set_parameter(config, key, value, "--set");
    } catch (const model::ConfigError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(refusal("technology.node_nm", "5"),
            "--set: technology.node_nm: found '5'; allowed: an integer from 7 to 130");
  EXPECT_EQ(refusal("technology.node_nm", "28.5"),
            "--set: technology.node_nm: found '28.5'; allowed: an integer from 7 to 130");
  EXPECT_EQ(refusal("technology.voltage_v", "0.3"),
            "--set: technology.voltage_v: found '0.3'; allowed: a number from 0.6 to 1.4");
}

}  // namespace technology_test
