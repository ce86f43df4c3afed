// A simulation runs until nothing is left to happen, or until it is stopped.

#include "model/time/run_until_idle.hpp"

#include "tests/support/systemc_fixture.hpp"

namespace run_until_idle_test {

using sc_core::SC_SEC;
using sc_core::sc_time;

class RunUntilIdle : public test_support::SystemCFixture {};

TEST_F(RunUntilIdle, EventsManySecondsAwayAreWaitedForAndTimeStaysAtTheLast) {
  int steps = 0;
  sc_core::sc_spawn([&] {
    for (; steps < 3; ++steps) sc_core::wait(sc_time(2.25, SC_SEC));
  });
  model::run_until_idle();
  EXPECT_EQ(steps, 3);
  EXPECT_EQ(sc_core::sc_time_stamp(), sc_time(6.75, SC_SEC));
}

TEST_F(RunUntilIdle, NothingToDoTakesNoTime) {
  model::run_until_idle();
  EXPECT_EQ(sc_core::sc_time_stamp(), sc_core::SC_ZERO_TIME);
}

TEST_F(RunUntilIdle, StopsWhereAProcessStopsTheSimulation) {
  sc_core::sc_spawn([] {
    sc_core::wait(sc_time(1.5, SC_SEC));
    sc_core::sc_stop();
    for (;;) sc_core::wait(sc_time(1, SC_SEC));
  });
  model::run_until_idle();
  EXPECT_EQ(sc_core::sc_time_stamp(), sc_time(1.5, SC_SEC));
}

}  // namespace run_until_idle_test
