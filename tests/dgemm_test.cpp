#include "firmware/examples/dgemm.hpp"

#include <gtest/gtest.h>

#include "tests/support/native_example.hpp"

namespace {

using examples::Dgemm;
using test_support::levels;
using test_support::run_natively;
using test_support::verdict;
using testbench::dgemm_run;

Dgemm::Problem problem(Dgemm::Shape shape, int row_blocks, int column_blocks, int depth_blocks) {
  Dgemm::Problem problem;
  problem.shape = shape;
  problem.row_blocks = row_blocks;
  problem.column_blocks = column_blocks;
  problem.depth_blocks = depth_blocks;
  return problem;
}

TEST(DgemmExample, IsTheHostsProduct) {
  for (const cn::Level level : levels()) {
    for (const Dgemm::Problem& of : {problem({}, 1, 1, 1), problem({}, 2, 1, 3), problem({4, 3, 1}, 1, 3, 5),
                                     problem({8, 6, 5}, 3, 2, 2), problem({4, 126, 16}, 1, 1, 2)}) {
      const testbench::ExampleRun run = dgemm_run(of, 24, level);
      EXPECT_EQ(verdict(run, run_natively(run, 24)), "") << int(level) << " rows " << of.shape.rows;
    }
  }
}

TEST(DgemmExample, WorkIsAMultiplyAndAnAddForEachProduct) {
  // (2 x 24 x 8) x (3 x 6) x (4 x 5)
  EXPECT_EQ(dgemm_run(problem({8, 6, 5}, 2, 3, 4), 24, cn::Level::x86_64_v2).work, 2.0 * 384 * 18 * 20);
}

TEST(DgemmExample, LevelsGiveTheSameBits) {
  const Dgemm::Problem of = problem({}, 1, 2, 3);
  const auto first = run_natively(dgemm_run(of, 16, cn::Level::x86_64_v2), 16);
  for (const cn::Level level : levels()) EXPECT_EQ(run_natively(dgemm_run(of, 16, level), 16), first);
}

TEST(DgemmExample, CheckNoticesOneWrongElement) {
  const testbench::ExampleRun run = dgemm_run(problem({}, 1, 1, 2), 8, cn::Level::x86_64_v2);
  std::vector<std::uint8_t> mono = run_natively(run, 8);
  mono[mono.size() - 2] ^= 0x10;  // in the exponent of C's last element
  EXPECT_NE(verdict(run, mono).find("DGEMM: element ("), std::string::npos);
  EXPECT_NE(verdict(run, run.mono), "");  // C as it was before the run
}

TEST(DgemmExample, ShapeMustFitVectorsRegistersAndSram) {
  const auto fault = [](Dgemm::Shape shape) -> std::string {
    try {
      run_natively(dgemm_run(problem(shape, 1, 1, 1), 8, cn::Level::x86_64_v2), 8);
      return {};
    } catch (const std::exception& error) {
      return error.what();
    }
  };
  EXPECT_EQ(fault({6, 3, 1}), "DGEMM rows: found 6, allowed is a positive multiple of 4");
  EXPECT_EQ(fault({4, 4, 1}), "DGEMM columns: found 4, allowed is a positive multiple of 3");
  EXPECT_EQ(fault({4, 3, 0}), "DGEMM depth: found 0, allowed is a positive multiple of 1");
  EXPECT_NE(fault({64, 30, 1}).find("poly SRAM overflow: buffer 'C'"), std::string::npos);
}

}  // namespace
