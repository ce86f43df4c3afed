// Boards of several chips behind one host link: the image is that of one chip, and the work is divided.

#include "testbench/run/render.hpp"
#include "testbench/system/error.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/systemc_fixture.hpp"

namespace board_test {

using model::TimingStyle;
using path_tracer::Program;
using testbench::BoardRender;
using testbench::RenderOptions;

class Board : public test_support::SystemCFixture, public testing::WithParamInterface<TimingStyle> {
 protected:
  BoardRender render(int chips) {
    new_context();
    return testbench::render_on_board(scene, options, chips);
  }
  testbench::Scene scene = test_support::small_cornell_box({24, 20});
  RenderOptions options = [] {
    RenderOptions some = test_support::render_options(Program::full, 16);
    some.timing = GetParam();
    return some;
  }();
};

TEST_P(Board, OfOneChipIsThatChip) {
  const BoardRender board = render(1);
  new_context();
  const testbench::RenderResult chip = testbench::render_on_chip(scene, options);
  EXPECT_EQ(board.film.sha256(), chip.film.sha256());
  EXPECT_EQ(board.firmware_cycles, chip.chip->firmware_cycles);
  EXPECT_EQ(board.chips.at(0).total_cycles, chip.chip->total_cycles);
}

TEST_P(Board, GivesTheImageOfOneChipSooner) {
  const BoardRender one = render(1);
  for (const int chips : {2, 3}) {
    const BoardRender several = render(chips);
    EXPECT_EQ(several.film.sha256(), one.film.sha256());
    EXPECT_EQ(several.segments, one.segments);
    EXPECT_EQ(several.chips.size(), std::size_t(chips));
    const double speedup = double(one.firmware_cycles) / double(several.firmware_cycles);
    EXPECT_GT(speedup, 0.6 * chips);
    EXPECT_LT(speedup, 1.02 * chips);
  }
}

/// Each chip gets the whole scene, and the uploads come one after the other.
TEST_P(Board, ChipsTakeTurnsOnTheHostLink) {
  const BoardRender two = render(2);
  const model::HostLinkStatistics& first = two.chips[0].host_link;
  const model::HostLinkStatistics& second = two.chips[1].host_link;
  EXPECT_EQ(first.bytes_uploaded, second.bytes_uploaded);
  EXPECT_LE(first.busy_cycles + second.busy_cycles,
            std::max(two.chips[0].total_cycles, two.chips[1].total_cycles));
  const double upload_cycles =
      double(first.bytes_uploaded) / options.chip.host.bytes_per_second * options.chip.chip.clock_hz;
  EXPECT_GT(double(two.chips[1].total_cycles - two.chips[1].firmware_cycles), 2 * upload_cycles);
}

TEST_P(Board, RefusesFewerSamplesThanChips) {
  options.work.samples = 3;
  EXPECT_THROW(render(4), testbench::InputError);
  EXPECT_THROW(render(0), testbench::InputError);
}

INSTANTIATE_TEST_SUITE_P(Styles, Board,
                         testing::Values(TimingStyle::loosely_timed, TimingStyle::approximately_timed),
                         [](const testing::TestParamInfo<TimingStyle>& style) {
                           return style.param == TimingStyle::loosely_timed ? "Lt" : "At";
                         });

}  // namespace board_test
