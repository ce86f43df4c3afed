#include "testbench/paper/paper.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "firmware/path_tracer/program/program_options.hpp"

namespace paper_test {

using path_tracer::Program;
using testbench::paper_rows;
using testbench::PaperRow;

/// As docs/paper.md, section 4.1, has them.
struct Cells {
  int table;
  const char* label;
  int n;
  bool loads;
  bool saves;
  double segments;
  double direct;
  double full;
};

constexpr Cells kDesign[] = {
    {1, "n = 0", 0, true, true, 7.63, 16.84, 16.97},  {1, "n = 1", 1, true, true, 5.94, 13.17, 13.28},
    {1, "n = 2", 2, true, true, 5.94, 13.21, 13.36},  {1, "n = 3", 3, true, true, 5.96, 13.46, 13.61},
    {2, "none", 1, false, false, 7.63, 16.84, 16.97}, {2, "loads", 1, true, false, 6.64, 14.81, 14.96},
    {2, "saves", 1, false, true, 6.85, 15.49, 15.63}, {2, "both", 1, true, true, 5.94, 13.17, 13.28},
};

TEST(Paper, RowsAreTheDesigns) {
  ASSERT_EQ(paper_rows().size(), std::size(kDesign));
  for (std::size_t i = 0; i < std::size(kDesign); ++i) {
    const PaperRow& row = paper_rows()[i];
    const Cells& cells = kDesign[i];
    EXPECT_EQ(row.table, cells.table);
    EXPECT_STREQ(row.label, cells.label);
    EXPECT_EQ(row.n, cells.n) << row.label;
    EXPECT_EQ(row.buffer_loads, cells.loads) << row.label;
    EXPECT_EQ(row.buffer_saves, cells.saves) << row.label;
    EXPECT_EQ(row.seconds[std::size_t(Program::segments)], cells.segments) << row.label;
    EXPECT_EQ(row.seconds[std::size_t(Program::direct)], cells.direct) << row.label;
    EXPECT_EQ(row.seconds[std::size_t(Program::full)], cells.full) << row.label;
  }
}

TEST(Paper, SiliconIsTheDoubleBufferedRow) {
  EXPECT_NEAR(testbench::silicon_segments_per_second(Program::segments), 168350, 1);
  EXPECT_NEAR(testbench::silicon_segments_per_second(Program::direct), 75930, 1);
  EXPECT_NEAR(testbench::silicon_segments_per_second(Program::full), 75301, 1);
}

TEST(Paper, CellsAreTheNumbersOfTheTablesRowByRow) {
  const auto cells = testbench::paper_cells();
  ASSERT_EQ(cells.size(), 24u);
  EXPECT_EQ(cells[0].name(), "segments, n = 0");
  EXPECT_EQ(cells[4].name(), "direct, n = 1");
  EXPECT_EQ(cells[23].name(), "full, both");
  for (std::size_t i = 0; i < cells.size(); ++i)
    EXPECT_EQ(cells[i].seconds(), paper_rows()[i / 3].seconds[i % 3]) << cells[i].name();
}

TEST(Paper, ThreeCellsAreFittedAndTheirRepetitionsAreNotPredictions) {
  std::vector<std::string> names;
  for (const auto& cell : testbench::fitted_cells()) names.push_back(cell.name());
  EXPECT_EQ(names, (std::vector<std::string>{"segments, n = 1", "segments, n = 0", "direct, n = 1"}));
  std::set<std::string> fitted;
  for (const auto& cell : testbench::paper_cells())
    if (testbench::is_fitted(cell)) fitted.insert(cell.name());
  EXPECT_EQ(fitted, (std::set<std::string>{"segments, n = 0", "segments, n = 1", "direct, n = 1",
                                           "segments, none", "segments, both", "direct, both"}));
}

TEST(Paper, ProgramCastsAShadowRayForEverySegment) {
  const path_tracer::ProgramConfig program = testbench::paper_program();
  EXPECT_NO_THROW(path_tracer::validate(program));
  EXPECT_FALSE(program.cull_shadow_rays);
  EXPECT_EQ(program.bin_blocks, 8);
  EXPECT_EQ(program.roulette_start, 8);
}

TEST(Paper, ProgramsHaveTheNamesOfTheCommandLine) {
  EXPECT_STREQ(path_tracer::name_of(Program::segments), "segments");
  EXPECT_STREQ(path_tracer::name_of(Program::direct), "direct");
  EXPECT_STREQ(path_tracer::name_of(Program::full), "full");
}

}  // namespace paper_test
