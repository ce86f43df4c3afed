// Processes come last at a time: after everything else, one after the other.

#include "model/time/last_in_time.hpp"

#include <string>

#include "tests/support/systemc_fixture.hpp"

namespace last_in_time_test {

using sc_core::SC_NS;
using sc_core::sc_time;

class LastInTime : public test_support::SystemCFixture {
 protected:
  /// A process that waits until 10 ns and then `steps` times for a delta cycle.
  sc_core::sc_process_handle spawn(const std::string& name, int steps) {
    return sc_core::sc_spawn([this, name, steps] {
      sc_core::wait(sc_time(10, SC_NS));
      for (int step = 0; step < steps; ++step) {
        sc_core::wait(sc_core::SC_ZERO_TIME);
        log += name;
      }
    });
  }
  /// One that comes last at 10 ns, `times` times, and causes an activity of `steps` delta cycles each time.
  sc_core::sc_process_handle spawn_last(const std::string& name, int times, int steps) {
    const std::size_t place = last.join();
    return sc_core::sc_spawn([this, name, place, times, steps] {
      sc_core::wait(sc_time(10, SC_NS));
      for (int i = 0; i < times; ++i) {
        last.come_last(place);
        EXPECT_EQ(sc_core::sc_time_stamp(), sc_time(10, SC_NS));
        log += name;
        for (int step = 0; step < steps; ++step)
          sc_core::sc_spawn([this, step] {
            for (int delta = 0; delta <= step; ++delta) sc_core::wait(sc_core::SC_ZERO_TIME);
            log += '-';
          });
      }
    });
  }
  void run() { sc_core::sc_start(sc_time(1, sc_core::SC_SEC), sc_core::SC_EXIT_ON_STARVATION); }

  model::LastInTime last;
  std::string log;
};

TEST_F(LastInTime, OneComesAfterAllThatHappens) {
  spawn_last("A", 1, 0);
  spawn("x", 5);
  run();
  EXPECT_EQ(log, "xxxxxA");
}

TEST_F(LastInTime, SeveralComeOneAfterTheOtherWithWhatTheyCause) {
  spawn_last("A", 2, 3);
  spawn("x", 4);
  spawn_last("B", 2, 2);
  spawn_last("C", 1, 0);
  run();
  EXPECT_EQ(log, "xxxxA---A---B--B--C");
}

TEST_F(LastInTime, TheOrderIsThatOfPlacesNotOfProcesses) {
  const std::size_t first = last.join();
  const std::size_t second = last.join();
  for (const std::size_t place : {second, first})
    sc_core::sc_spawn([this, place] {
      last.come_last(place);
      log += std::to_string(place);
    });
  run();
  EXPECT_EQ(log, "01");
}

TEST_F(LastInTime, AProcessThatIsEndedHandsTheWatchOn) {
  sc_core::sc_process_handle watching = spawn_last("A", 1, 0);
  spawn("x", 4);
  spawn_last("B", 1, 0);
  sc_core::sc_spawn([&] {
    sc_core::wait(sc_time(10, SC_NS));
    sc_core::wait(sc_core::SC_ZERO_TIME);
    watching.kill();
  });
  run();
  EXPECT_EQ(log, "xxxxB");
}

}  // namespace last_in_time_test
