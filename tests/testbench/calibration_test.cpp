// Tests `csx600 calibrate` at a reduced size. The constants differ from those of the preset, because the
// beginning and the end of a run have a larger share, but the method and the structure of the predictions are
// the same.

#include "testbench/paper/calibration.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "firmware/path_tracer/program/program_options.hpp"
#include "model/config/chip_presets.hpp"
#include "testbench/paper/paper_alternatives.hpp"
#include "testbench/system/error.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/systemc_fixture.hpp"

namespace calibration_test {

using path_tracer::Program;
using testbench::Assumptions;
using testbench::calibrate;
using testbench::Calibration;
using testbench::CalibrationOptions;
using testbench::FittedConstants;
using testbench::paper_cells;
using testbench::paper_rows;
using testbench::PaperCell;
using testbench::RenderOptions;
using testbench::RenderResult;
using testbench::Scene;

constexpr double kFitTolerance = 0.004;

Assumptions small_paper() {
  return {"preset paper", model::preset("paper"), testbench::paper_program(),
          test_support::small_cornell_box({48, 48})};
}

CalibrationOptions small_options() {
  return {1, 2, testbench::widest_level()};
}

double seconds(const Calibration& result, const char* label, Program program) {
  const std::vector<PaperCell> cells = paper_cells();
  const auto found = std::find_if(cells.begin(), cells.end(), [&](const PaperCell& cell) {
    return cell.program == program && paper_rows()[cell.row].label == std::string(label);
  });
  EXPECT_NE(found, cells.end()) << label;
  return result.seconds[std::size_t(found - cells.begin())];
}

TEST(Calibration, MeetsTheFittedCellsAndPredictsTheOthers) {
  const Calibration result = calibrate(small_paper(), small_options());
  EXPECT_TRUE(result.converged);
  EXPECT_GE(result.iterations, 1);
  const std::vector<PaperCell> cells = paper_cells();
  ASSERT_EQ(result.seconds.size(), cells.size());
  int fitted = 0;
  int predicted = 0;
  double sum = 0;
  double worst = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const double error = std::abs(result.seconds[i] / cells[i].seconds() - 1);
    if (is_fitted(cells[i])) {
      EXPECT_LT(error, kFitTolerance) << cells[i].name();
      ++fitted;
    } else {
      sum += error;
      worst = std::max(worst, error);
      ++predicted;
    }
  }
  // The rows "none" and "both" of Table 2 repeat the three cells.
  EXPECT_EQ(fitted, 6);
  EXPECT_EQ(predicted, 18);
  EXPECT_NEAR(result.mean_error, sum / predicted, 1e-12);
  EXPECT_EQ(result.worst_error, worst);
  EXPECT_LT(result.mean_error, 0.04);
}

TEST(Calibration, PredictionsHaveTheStructureOfTheTables) {
  const Calibration result = calibrate(small_paper(), small_options());
  for (const Program program : testbench::kPaperPrograms) {
    SCOPED_TRACE(path_tracer::name_of(program));
    const auto of = [&](const char* label) { return seconds(result, label, program); };
    EXPECT_LT(of("n = 1"), 0.9 * of("n = 0"));
    EXPECT_GE(of("n = 2"), of("n = 1"));
    EXPECT_GE(of("n = 3"), of("n = 1"));
    EXPECT_EQ(of("none"), of("n = 0"));
    EXPECT_EQ(of("both"), of("n = 1"));
    for (const char* one_way : {"loads", "saves"}) {
      EXPECT_LT(of(one_way), of("none"));
      EXPECT_GT(of(one_way), of("both"));
    }
  }
  for (const Program program : {Program::direct, Program::full})
    EXPECT_LT(seconds(result, "loads", program), seconds(result, "saves", program))
        << "buffering loads is worth more than buffering saves";
  for (const char* label : {"n = 2", "n = 3"}) {
    const auto over_double_buffering = [&](Program program) {
      return seconds(result, label, program) - seconds(result, "n = 1", program);
    };
    EXPECT_GT(over_double_buffering(Program::direct), over_double_buffering(Program::segments)) << label;
  }
  for (const char* label : {"n = 0", "n = 1", "n = 2", "n = 3", "loads", "saves"}) {
    EXPECT_GT(seconds(result, label, Program::direct), 1.9 * seconds(result, label, Program::segments));
    EXPECT_GT(seconds(result, label, Program::full), seconds(result, label, Program::direct)) << label;
  }
}

TEST(Calibration, IsDeterministic) {
  Assumptions smaller = small_paper();
  smaller.scene.film = {32, 32};
  const Calibration first = calibrate(smaller, small_options());
  CalibrationOptions others = small_options();
  others.at_once = 1;
  others.level = cn::narrowest_level();
  const Calibration second = calibrate(smaller, others);
  EXPECT_EQ(second.constants.settings(), first.constants.settings());
  EXPECT_EQ(second.seconds, first.seconds);
  EXPECT_EQ(second.iterations, first.iterations);
}

TEST(Calibration, FindsTheSameConstantsFromElsewhere) {
  const Calibration near = calibrate(small_paper(), small_options());
  Assumptions far = small_paper();
  testbench::apply({3.0, 40, 900}, far.chip);
  const Calibration found = calibrate(far, small_options());
  EXPECT_TRUE(found.converged);
  EXPECT_NEAR(found.constants.code_quality_factor, near.constants.code_quality_factor,
              0.03 * near.constants.code_quality_factor);
  EXPECT_NEAR(found.constants.per_pe_cycles, near.constants.per_pe_cycles, 2);
  EXPECT_NEAR(found.constants.transfer_call_cycles, near.constants.transfer_call_cycles,
              0.15 * near.constants.transfer_call_cycles);
}

TEST(Calibration, LeavesTheCallAloneWhereItIsNotFitted) {
  Assumptions two_constants = small_paper();
  two_constants.fits_transfer_call = false;
  model::ChipConfig& chip = two_constants.chip;
  chip.control.transfer_call_cycles = 1234;
  const Calibration result = calibrate(two_constants, small_options());
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.constants.transfer_call_cycles, 1234);
  for (const char* label : {"n = 0", "n = 1"})
    EXPECT_NEAR(seconds(result, label, Program::segments), std::string(label) == "n = 0" ? 7.63 : 5.94,
                kFitTolerance * 7.63);
}

/// Two chips are nearly twice as fast, so the code of each may be nearly twice as slow.
TEST(Calibration, TwoChipsShareTheWork) {
  Assumptions both = small_paper();
  both.chip.board.chips = 2;
  CalibrationOptions options = small_options();
  options.samples = 8;
  const Calibration one = calibrate(small_paper(), options);
  const Calibration two = calibrate(both, options);
  EXPECT_TRUE(two.converged);
  EXPECT_NEAR(seconds(two, "n = 1", Program::segments), 5.94, kFitTolerance * 5.94);
  EXPECT_GT(two.constants.code_quality_factor, 1.7 * one.constants.code_quality_factor);
  EXPECT_LT(two.constants.code_quality_factor, 2.1 * one.constants.code_quality_factor);
}

TEST(Calibration, SaysWhenTheCellsCannotBeMet) {
  Assumptions slow = small_paper();
  slow.scene.film = {16, 16};
  slow.chip.chip.clock_hz = 10e6;
  const Calibration result = calibrate(slow, small_options());
  EXPECT_FALSE(result.converged);
  EXPECT_GT(result.mean_error, 0.5);
}

TEST(FittedConstants, AreSetAndWrittenAsTheSettingsSay) {
  const FittedConstants constants{7.25, 19, 3000};
  model::ChipConfig chip = model::preset("csx600");
  testbench::apply(constants, chip);
  EXPECT_EQ(chip.poly.code_quality_factor, 7.25);
  EXPECT_EQ(chip.pio.per_pe_cycles, 19);
  EXPECT_EQ(chip.control.transfer_call_cycles, 3000);
  const std::string header = testbench::paper_constants_header(constants);
  for (const char* line :
       {"// poly.code_quality_factor\ninline constexpr const char* kPaperCodeQualityFactor = \"7.2500\";\n",
        "// pio.per_pe_cycles\ninline constexpr const char* kPaperPerPeCycles = \"19\";\n",
        "// control.transfer_call_cycles\ninline constexpr const char* kPaperTransferCallCycles = "
        "\"3000\";\n"})
    EXPECT_NE(header.find(line), std::string::npos) << header;
}

/// Renders with preset paper at a size for tests. The difference of a long and a short run cancels the
/// beginning and the end, whose share is small in a run of a million paths.
class PresetPaper : public test_support::SystemCFixture {
 protected:
  static RenderResult run(const PaperCell& cell, int samples) {
    new_context();
    RenderOptions options = test_support::render_options(cell.program, samples);
    options.chip = model::preset("paper");
    options.program = testbench::paper_program();
    options.program.program = cell.program;
    options.program.n = paper_rows()[cell.row].n;
    return testbench::render_on_chip(test_support::small_cornell_box({48, 48}), options);
  }
};

TEST_F(PresetPaper, MeetsTheFittedCells) {
  for (const PaperCell& cell : testbench::fitted_cells()) {
    const RenderResult few = run(cell, 4);
    const RenderResult many = run(cell, 16);
    const double found = (many.chip->seconds() - few.chip->seconds()) * 1e6 /
                         double(many.counts.segments - few.counts.segments);
    EXPECT_NEAR(found / cell.seconds(), 1.0, 0.03) << cell.name();
  }
}

}  // namespace calibration_test
