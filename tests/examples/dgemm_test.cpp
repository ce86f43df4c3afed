#include "firmware/examples/dgemm.hpp"

#include <gtest/gtest.h>

#include "model/config/chip_parameters.hpp"
#include "model/csx600.hpp"
#include "tests/support/native_example.hpp"
#include "tests/support/systemc_fixture.hpp"

namespace dgemm_test {

using examples::Dgemm;
using test_support::run_natively;
using test_support::verdict;
using testbench::dgemm_run;

/// Tries several numbers of blocks of C and of panels.
Dgemm::Problem problem(Dgemm::Shape shape, int row_blocks, int column_blocks, int panels) {
  Dgemm::Problem problem;
  problem.shape = shape;
  problem.row_blocks = row_blocks;
  problem.column_blocks = column_blocks;
  problem.panels = panels;
  return problem;
}

TEST(DgemmExample, IsTheHostsProduct) {
  const auto expect = [](const Dgemm::Problem& of, int num_pes, cn::Level level) {
    const testbench::ExampleRun run = dgemm_run(of, num_pes, level);
    EXPECT_EQ(verdict(run, run_natively(run, num_pes)), "")
        << "level " << int(level) << ", tiles " << of.shape.tiles << ", PEs " << num_pes;
  };
  for (const cn::Level level : cn::usable_levels()) {
    for (const Dgemm::Problem& of : {problem({}, 1, 1, 1), problem({}, 2, 1, 3), problem({1, 8, 1}, 1, 3, 5),
                                     problem({6, 16, 2}, 3, 2, 2), problem({24, 32, 4}, 1, 1, 2)})
      expect(of, 24, level);
    // One strip that computes, as many as the chip's, and more.
    for (const int num_pes : {16, 96, 192}) expect(problem({12, 24, 4}, 1, 2, 3), num_pes, level);
  }
}

TEST(DgemmExample, RowsOfBMayLieInTheScratchpad) {
  const Dgemm::Problem of = problem({6, 16, 2}, 3, 2, 2);
  const cn::MonoRange scratchpad{std::uint64_t{1} << 40, 24 * 2 * 32 * 8};
  const testbench::ExampleRun run = dgemm_run(of, 24, cn::narrowest_level(), scratchpad);
  EXPECT_EQ(run.scratchpad.size(), scratchpad.bytes) << "4 x 6 x 2 columns, 16 x 2 rows";
  const std::vector<std::uint8_t> mono = run_natively(run, 24, scratchpad);
  EXPECT_EQ(verdict(run, mono), "");
  const testbench::ExampleRun all_in_ddr = dgemm_run(of, 24, cn::narrowest_level());
  const std::size_t c_bytes = std::size_t{2} * 16 * 3 * 48 * 8;
  const std::vector<std::uint8_t> same = run_natively(all_in_ddr, 24);
  EXPECT_TRUE(
      std::equal(mono.end() - std::ptrdiff_t(c_bytes), mono.end(), same.end() - std::ptrdiff_t(c_bytes)));
  EXPECT_THROW(dgemm_run(of, 24, cn::narrowest_level(), {scratchpad.first, scratchpad.bytes - 8}),
               testbench::InputError);
}

/// What a run on the chip has counted; its result was right.
struct ChipRun {
  model::Cycles cycles;
  std::uint64_t sram_bytes_read;
  std::uint64_t ddr_bytes_read;
};

ChipRun run_on_chip(const Dgemm::Problem& of, bool b_on_chip) {
  const model::ChipConfig config = model::default_chip_config();
  const cn::MonoRange scratchpad = b_on_chip ? model::on_chip_sram_range(config) : cn::MonoRange{};
  const testbench::ExampleRun run = dgemm_run(of, config.chip.pes, cn::narrowest_level(), scratchpad);
  model::Csx600 chip("chip", config);
  std::copy(run.mono.begin(), run.mono.end(), chip.mono_ddr->memory().data());
  std::copy(run.scratchpad.begin(), run.scratchpad.end(), chip.on_chip_sram->memory().begin());
  chip.control_unit.load(run.firmware);
  sc_core::sc_start(sc_core::SC_ZERO_TIME);
  chip.control_unit.start();
  sc_core::sc_start();
  chip.control_unit.require_finished();
  run.check(chip.mono_ddr->memory().data());
  return {chip.control_unit.statistics().total(), chip.on_chip_sram_statistics().bytes_read,
          chip.ddr_statistics().bytes_read};
}

class DgemmOnChip : public test_support::SystemCFixture {};

/// The DDR's bytes of B go to the SRAM. It hardly helps: the PIO engine takes as long for its 8 PEs.
TEST_F(DgemmOnChip, ReadsBFromTheScratchpad) {
  const Dgemm::Problem of = problem({20, 64, 2}, 2, 1, 3);
  const ChipRun in_ddr = run_on_chip(of, false);
  new_context();
  const ChipRun on_chip = run_on_chip(of, true);
  const std::uint64_t b_bytes = std::uint64_t{2} * 192 * 80 * 8;
  EXPECT_EQ(in_ddr.sram_bytes_read, 0u);
  EXPECT_EQ(on_chip.sram_bytes_read, b_bytes);
  EXPECT_EQ(on_chip.ddr_bytes_read, in_ddr.ddr_bytes_read - b_bytes);
  EXPECT_LT(on_chip.cycles, in_ddr.cycles);
}

TEST(DgemmExample, WorkIsAMultiplyAndAnAddForEachProduct) {
  // (2 x 16 x 2) x (4 x 6 x 3) x (16 x 4)
  EXPECT_EQ(dgemm_run(problem({6, 16, 2}, 2, 3, 4), 24, cn::narrowest_level()).work, 2.0 * 64 * 72 * 64);
}

TEST(DgemmExample, LevelsGiveTheSameBits) {
  const Dgemm::Problem of = problem({}, 1, 2, 3);
  const auto first = run_natively(dgemm_run(of, 16, cn::narrowest_level()), 16);
  for (const cn::Level level : cn::usable_levels())
    EXPECT_EQ(run_natively(dgemm_run(of, 16, level), 16), first);
}

TEST(DgemmExample, CheckNoticesOneWrongElement) {
  const testbench::ExampleRun run = dgemm_run(problem({}, 1, 1, 2), 16, cn::narrowest_level());
  std::vector<std::uint8_t> mono = run_natively(run, 16);
  mono[mono.size() - 2] ^= 0x10;  // in the exponent of C's last element
  EXPECT_NE(verdict(run, mono).find("DGEMM: element ("), std::string::npos);
  EXPECT_NE(verdict(run, run.mono), "");  // C as it was before the run
}

TEST(DgemmExample, ShapeMustFitPathFeedersAndSram) {
  const auto fault = [](Dgemm::Shape shape, int num_pes = 16) -> std::string {
    testbench::NativeMachine machine(num_pes, 6144, 8);
    try {
      const Dgemm dgemm(machine, examples::kernels(cn::narrowest_level()), problem(shape, 1, 1, 1));
      return {};
    } catch (const std::exception& error) {
      return error.what();
    }
  };
  EXPECT_EQ(fault({}), "");
  EXPECT_EQ(fault({}, 8), "DGEMM: found 8 PEs, allowed are more than 8");
  EXPECT_EQ(fault({6, 8, 4}), "DGEMM tiles: found 6, allowed is a positive multiple of 4");
  EXPECT_EQ(fault({6, 8, 0}), "DGEMM chunk_tiles: found 0, allowed is a positive multiple of 1");
  EXPECT_EQ(fault({6, 12, 2}), "DGEMM depth: found 12, allowed is a positive multiple of 8");
  EXPECT_EQ(
      fault({4, 16, 4}),
      "DGEMM: found two chunks of 256 bytes in a feeder, allowed are together the 256 bytes that C has");
  EXPECT_NE(fault({100, 8, 1}).find("poly SRAM overflow: buffer 'C'"), std::string::npos);
}

}  // namespace dgemm_test
