#include "testbench/run/energy.hpp"

#include "model/csx600.hpp"

#include <gtest/gtest.h>

#include <cstring>

#include "firmware/examples/firmwares.hpp"
#include "model/config/chip_file.hpp"
#include "model/config/chip_parameters.hpp"
#include "testbench/run/area.hpp"
#include "testbench/run/render.hpp"
#include "testbench/statistics/roofline.hpp"
#include "testbench/validation/example_runs.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/systemc_fixture.hpp"

namespace energy_test {

using cn::InstructionClass;
using testbench::ChipStatistics;
using testbench::Energy;
using testbench::ExampleRun;

class EnergyOfRuns : public test_support::SystemCFixture {
 protected:
  /// Statistics of a small firmware on a chip whose mono memory is filled beforehand.
  static ChipStatistics statistics_of(const model::ChipConfig& config, const ExampleRun& run) {
    new_context();
    model::Csx600 chip("chip", config);
    std::memcpy(chip.mono_ddr->memory().data(), run.mono.data(), run.mono.size());
    chip.control_unit.load(run.firmware);
    sc_core::sc_start(sc_core::SC_ZERO_TIME);
    chip.control_unit.start();
    sc_core::sc_start();
    chip.control_unit.rethrow_failure();
    run.check(chip.mono_ddr->memory().data());
    return testbench::collect_statistics(chip, chip.control_unit.now());
  }

  /// The DGEMM that `csx600 validate` runs.
  static ExampleRun dgemm(const model::ChipConfig& config) {
    return testbench::dgemm_run(examples::validated_dgemm(), config.chip.pes, testbench::widest_level());
  }
};

double joules_of(const Energy& energy, const std::string& cause) {
  for (const Energy::Cause& of : energy.causes)
    if (of.name == cause) return of.joules;
  return 0;
}

TEST_F(EnergyOfRuns, DgemmTakesTheVendorsTenWatts) {
  const model::ChipConfig config = model::default_chip_config();
  const ChipStatistics run = statistics_of(config, dgemm(config));
  const Energy energy = testbench::energy_of(run);
  EXPECT_NEAR(energy.chip_joules() / energy.seconds, 10, 0.1);
  // A board with two chips, their memory, an FPGA and regulators takes 25 W typically.
  EXPECT_LT(2 * energy.joules() / energy.seconds, 25);
  for (const Energy::Cause& cause : energy.causes)
    RecordProperty(cause.name, std::to_string(cause.joules / energy.seconds));
}

TEST_F(EnergyOfRuns, MonteCarloLeavesTheBoardSomeOfItsTwentyFiveWatts) {
  // The vendor measured its board at 25 W with this program: two chips, their memory, an FPGA and regulators.
  const model::ChipConfig config = model::default_chip_config();
  examples::MonteCarlo::Problem problem;
  problem.kernels = 16;
  const Energy energy = testbench::energy_of(
      statistics_of(config, testbench::monte_carlo_run(problem, config.chip.pes, testbench::widest_level())));
  const double board_watts = 2 * energy.joules() / energy.seconds;
  RecordProperty("board_watts", std::to_string(board_watts));
  EXPECT_LT(board_watts, 25);
}

/// Statistics of a run with one kernel; all counts differ.
ChipStatistics made_up_run() {
  ChipStatistics run;
  run.config = model::default_chip_config();
  run.total_cycles = 1000000;
  run.firmware_cycles = 900000;
  run.control.cycles[std::size_t(model::CycleCause::poly)] = 500000;
  run.control.cycles[std::size_t(model::CycleCause::mono)] = 100000;
  run.control.cycles[std::size_t(model::CycleCause::wait_load)] = 200000;
  run.control.cycles[std::size_t(model::CycleCause::wait_host)] = 100000;
  for (std::size_t i = 0; i < cn::kInstructionClasses; ++i)
    run.all_kernels.executed.by_class[i] = 1000 * (i + 1);
  run.pio.bytes_to_poly = 70000;
  run.pio.bytes_to_mono = 30000;
  run.poly_sram.words_in = 9000;
  run.poly_sram.words_out = 4000;
  run.bus_pio.bytes = 100000;
  run.bus_control.bytes = 3000;
  run.bus_host.bytes = 500;
  run.ddr.page_misses = 700;
  run.ddr.bytes_read = 71000;
  run.ddr.bytes_written = 31000;
  run.ddr.refreshes = 610;
  return run;
}

TEST(Energy, IsCountsTimesTheTable) {
  ChipStatistics run = made_up_run();
  run.config.energy.chip_scale = 4;
  run.config.poly.code_quality_factor = 3;
  const model::ChipConfig::Energy& table = run.config.energy;
  const Energy energy = testbench::energy_of(run);
  const double seconds = 1000000 / 210e6;
  const auto per = [&](InstructionClass c) { return table.picojoules[std::size_t(c)]; };
  const auto executed = [&](InstructionClass c) { return double(run.all_kernels.executed[c]); };
  EXPECT_DOUBLE_EQ(energy.seconds, seconds);
  EXPECT_DOUBLE_EQ(joules_of(energy, "fp64_mul"),
                   4e-12 * 3 * per(InstructionClass::fp64_mul) * executed(InstructionClass::fp64_mul));
  EXPECT_DOUBLE_EQ(joules_of(energy, "poly_sram"), 4e-12 * per(InstructionClass::sram) *
                                                       (3 * (executed(InstructionClass::sram) +
                                                             executed(InstructionClass::sram_vector_load)) +
                                                        2 * 13000));
  EXPECT_DOUBLE_EQ(
      joules_of(energy, "swazzle"),
      4e-12 * 3 *
          (per(InstructionClass::swazzle) * executed(InstructionClass::swazzle) +
           per(InstructionClass::swazzle_vector4) * executed(InstructionClass::swazzle_vector4)));
  EXPECT_DOUBLE_EQ(joules_of(energy, "pe_clock"), 4e-12 * table.pe_clock_picojoules * 96 * 1e6);
  EXPECT_DOUBLE_EQ(joules_of(energy, "control_unit"), 4e-12 * table.control_unit_picojoules * 600000);
  EXPECT_DOUBLE_EQ(joules_of(energy, "pio"), 4e-12 * table.pio_picojoules_per_byte * 100000);
  EXPECT_DOUBLE_EQ(joules_of(energy, "clear_connect"), 4e-12 * table.clear_connect_picojoules * 2 * 103500);
  EXPECT_DOUBLE_EQ(joules_of(energy, "leakage"),
                   (table.leakage_watts + 96 * table.leakage_watts_per_pe) * seconds);
  EXPECT_DOUBLE_EQ(joules_of(energy, "ddr_activate"), 1e-12 * table.ddr_activate_picojoules * 700);
  EXPECT_DOUBLE_EQ(joules_of(energy, "ddr_read"), 1e-12 * table.ddr_read_picojoules * 71000);
  EXPECT_DOUBLE_EQ(joules_of(energy, "ddr_write"), 1e-12 * table.ddr_write_picojoules * 31000);
  EXPECT_DOUBLE_EQ(joules_of(energy, "ddr_refresh"), 1e-12 * table.ddr_refresh_picojoules * 610);
  EXPECT_DOUBLE_EQ(joules_of(energy, "ddr_background"), table.ddr_background_watts * seconds);
}

TEST(Energy, OfASearchUnitIsItsCountsTimesTheTable) {
  ChipStatistics run = made_up_run();
  run.config.energy.chip_scale = 4;
  const double without = joules_of(testbench::energy_of(run), "leakage");
  const double network = joules_of(testbench::energy_of(run), "clear_connect");
  run.config.search_unit.units = 3;
  run.config.search_unit.clock_divider = 2;
  run.config.search_unit.hops = run.config.clear_connect.hops_to_ddr + 1;
  run.search_unit.node_tests = 400;
  run.search_unit.leaf_tests = 30;
  run.search_unit.cache_hits = 50;
  run.search_unit.cache_joins = 7;
  run.search_unit.cache_misses = 20;
  run.search_unit.bytes_written = 800;
  run.search_unit.bytes_read = 400;
  run.bus_search_unit.bytes = 1280;
  const model::ChipConfig::Energy& table = run.config.energy;
  const Energy energy = testbench::energy_of(run);
  EXPECT_DOUBLE_EQ(
      joules_of(energy, "search_unit"),
      4e-12 * (table.search_box_picojoules * 400 + table.search_leaf_picojoules * 30 +
               table.search_line_picojoules * (50 + 7 + 2 * 20) + table.search_picojoules_per_byte * 1200 +
               table.search_clock_picojoules * 3 * 1e6 / 2));
  EXPECT_DOUBLE_EQ(joules_of(energy, "leakage") - without, 3 * table.search_leakage_watts * energy.seconds);
  const int hops = run.config.clear_connect.hops_to_ddr;
  EXPECT_NEAR(joules_of(energy, "clear_connect") - network,
              4e-12 * table.clear_connect_picojoules * (hops * 1280 + 1200), 1e-15)
      << "lines from the DDR, and one hop more for rays and hits";
}

TEST(Area, IsPartsTimesTheTable) {
  model::ChipConfig config = model::default_chip_config();
  config.area = {0.5, 20, 0.25, 4, 0.125, 0.0625};
  EXPECT_DOUBLE_EQ(testbench::area_of(config).mm2(), 96 * 0.5 + 20);
  config.search_unit.units = 2;
  config.search_unit.width = 3;
  config.search_unit.leaf_interval_cycles = 8;
  config.search_unit.queries_in_flight = 10;
  config.search_unit.cache_bytes = 4096;
  config.search_unit.buffer_bytes = 65536;
  EXPECT_DOUBLE_EQ(testbench::area_of(config).mm2(),
                   96 * 0.5 + 20 + 2 * (3 * 0.25 + 4.0 / 8 + 10 * 0.125 + 4 * 0.0625) + 64 * 0.0625);
}

TEST(Energy, EveryEntryOfTheTableCounts) {
  ChipStatistics run = made_up_run();
  run.config.on_chip_sram.size_bytes = 65536;
  run.config.poly.sram_bytes = 8192;
  run.on_chip_sram = {10, 5000, 3000, 500};
  run.config.search_unit.units = 2;
  run.search_unit.node_tests = 400;
  run.search_unit.leaf_tests = 30;
  run.search_unit.cache_misses = 20;
  run.search_unit.bytes_written = 800;
  const double joules = testbench::energy_of(run).joules();
  int entries = 0;
  for (const model::ParameterInfo& parameter : model::parameter_table()) {
    if (parameter.key.rfind("energy.", 0) != 0) continue;
    ++entries;
    ChipStatistics other = run;
    parameter.write(other.config, 2 * std::get<double>(parameter.read(run.config)));
    EXPECT_GT(testbench::energy_of(other).joules(), joules) << parameter.key;
  }
  EXPECT_EQ(entries, 20 + int(cn::kInstructionClasses) - 1);  // all instruction classes except mono
}

TEST_F(EnergyOfRuns, CausesAddUpToTheTotal) {
  for (const char* preset : {"csx600", "paper", "csx700", "g80_like"}) {
    testbench::RenderOptions options = test_support::render_options(path_tracer::Program::full, 4);
    options.chip = model::load_chip(preset);
    new_context();
    const testbench::RenderResult result =
        testbench::render_on_chip(test_support::small_cornell_box({17, 5}), options);
    const Energy energy = testbench::energy_of(*result.chip);
    double chip = 0;
    double ddr = 0;
    for (const Energy::Cause& cause : energy.causes) {
      (cause.in_ddr ? ddr : chip) += cause.joules;
      EXPECT_GT(cause.joules, 0.0) << preset << ": " << cause.name;
    }
    EXPECT_EQ(chip + ddr, energy.joules()) << preset;
    EXPECT_EQ(energy.seconds, result.chip->total_seconds());
  }
}

TEST(Roofline, PeaksAreTheVendorsAndTheNearestRoofIsTheMostUsedOne) {
  ChipStatistics run = made_up_run();
  run.all_kernels.executed = {};
  run.all_kernels.executed[InstructionClass::fp64_multiply_add_vector4] = 1000;
  run.all_kernels.executed[InstructionClass::fp64_add] = 10;
  run.all_kernels.executed[InstructionClass::fp64_sqrt] = 1;
  run.all_kernels.executed[InstructionClass::int32_alu] = 1000000;
  const testbench::Roofline roofline = testbench::roofline_of(run);
  EXPECT_EQ(roofline.flops(), 8011);
  EXPECT_DOUBLE_EQ(roofline.roof("pe_array").peak_per_second, 96 * 2 * 210e6);  // 40.3 GFLOPS
  EXPECT_DOUBLE_EQ(roofline.roof("pio").peak_per_second, 8 * 210e6);
  EXPECT_DOUBLE_EQ(roofline.roof("clear_connect").peak_per_second, 2 * 8 * 210e6);
  EXPECT_DOUBLE_EQ(roofline.roof("ddr").peak_per_second, 16 * 210e6);
  const double seconds = 900000 / 210e6;
  EXPECT_DOUBLE_EQ(roofline.roof("pe_array").attained_per_second, 8011 / seconds);
  EXPECT_DOUBLE_EQ(roofline.roof("pio").attained_per_second, 100000 / seconds);
  EXPECT_DOUBLE_EQ(roofline.roof("ddr").attained_per_second, 102000 / seconds);
  EXPECT_EQ(roofline.nearest().name, "pio");
  EXPECT_DOUBLE_EQ(roofline.intensity("pio"), 8011 / 100000.0);
  EXPECT_DOUBLE_EQ(roofline.attainable_flops_per_second(), 8011 / 100000.0 * 8 * 210e6);
  run.config.pio.arbitration = model::PioArbitration::queue_per_direction;
  EXPECT_DOUBLE_EQ(testbench::roofline_of(run).roof("pio").peak_per_second, 16 * 210e6);
  run.config.ddr.bytes_per_cycle = 1;
  EXPECT_EQ(testbench::roofline_of(run).nearest().name, "ddr");
}

TEST_F(EnergyOfRuns, DgemmDoesTheOperationsThatItsWorkIs) {
  const model::ChipConfig config = model::default_chip_config();
  examples::Dgemm::Problem problem;
  const ExampleRun run = testbench::dgemm_run(problem, config.chip.pes, testbench::widest_level());
  const testbench::Roofline roofline = testbench::roofline_of(statistics_of(config, run));
  // The last 8 of the 96 PEs feed the others and multiply as well.
  EXPECT_NEAR(roofline.flops() / run.work, 96.0 / 88, 1e-12);
  EXPECT_EQ(roofline.roofs.size(), 4u);
}

}  // namespace energy_test
