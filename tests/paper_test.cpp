#include "testbench/paper.hpp"

#include <gtest/gtest.h>

#include <string>

namespace {

using path_tracer::Program;
using testbench::paper_rows;
using testbench::PaperRow;

/// As design.md, section 9, has them.
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

TEST(Paper, ProgramsHaveTheNamesOfTheCommandLine) {
  EXPECT_STREQ(testbench::program_name(Program::segments), "segments");
  EXPECT_STREQ(testbench::program_name(Program::direct), "direct");
  EXPECT_STREQ(testbench::program_name(Program::full), "full");
}

}  // namespace
