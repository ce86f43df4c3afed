#include "model/time/event_queue.hpp"

#include <random>

#include "tests/support/systemc_fixture.hpp"

namespace event_queue_test {

using model::Cycles;

class EventQueue : public test_support::SystemCFixture {
 protected:
  model::ClockDomain clock{1e9};
  model::EventQueue event_queue{"event_queue", clock};
  std::vector<std::pair<Cycles, int>> done;  ///< when, what

  void ask(Cycles cycle, int what) {
    event_queue.schedule(cycle, [this, what] { done.emplace_back(event_queue.now(), what); });
  }
};

TEST_F(EventQueue, DoesWhatIsAskedInItsCycleAndInTheOrderOfAsking) {
  ask(20, 0);
  ask(10, 1);
  ask(100000, 2);
  ask(20, 3);
  ask(10, 4);
  sc_core::sc_start();
  EXPECT_EQ(done, (std::vector<std::pair<Cycles, int>>{{10, 1}, {10, 4}, {20, 0}, {20, 3}, {100000, 2}}));
}

TEST_F(EventQueue, TasksAskForMoreInTheSameCycleAndLater) {
  event_queue.schedule(5, [this] {
    ask(5, 0);
    ask(4, 1);  // over: as soon as possible
    ask(6, 2);
    ask(5 + 256, 3);  // shares a list with cycle 5
    ask(5 + 512, 4);
  });
  ask(5, 5);
  sc_core::sc_start();
  EXPECT_EQ(done, (std::vector<std::pair<Cycles, int>>{{5, 5}, {5, 0}, {5, 1}, {6, 2}, {261, 3}, {517, 4}}));
}

TEST_F(EventQueue, NearAndFarEntriesOfOneCycleKeepTheirOrder) {
  ask(1000, 0);                                         // far
  event_queue.schedule(900, [this] { ask(1000, 1); });  // near by then
  ask(1000, 2);                                         // far
  sc_core::sc_start();
  EXPECT_EQ(done, (std::vector<std::pair<Cycles, int>>{{1000, 0}, {1000, 2}, {1000, 1}}));
}

TEST_F(EventQueue, ManyTasksComeInOrder) {
  std::mt19937 random(1);
  int asked = 0;
  for (; asked < 300; ++asked) ask(Cycles(random() % 2000), asked);
  event_queue.schedule(700, [&] {
    for (; asked < 600; ++asked) ask(Cycles(700 + random() % 2000), asked);
  });
  sc_core::sc_start();
  ASSERT_EQ(done.size(), 600u);
  for (std::size_t i = 1; i < done.size(); ++i) EXPECT_LE(done[i - 1].first, done[i].first);
  for (std::size_t i = 1; i < done.size(); ++i)
    if (done[i - 1].first == done[i].first) {
      EXPECT_LT(done[i - 1].second, done[i].second);
    }
}

TEST_F(EventQueue, SomethingSoonerWakesItSooner) {
  ask(500, 0);
  sc_core::sc_start(sc_core::sc_time(100, sc_core::SC_NS));
  ask(200, 1);
  ask(50, 2);
  sc_core::sc_start();
  EXPECT_EQ(done, (std::vector<std::pair<Cycles, int>>{{100, 2}, {200, 1}, {500, 0}}));
}

TEST_F(EventQueue, WaitsForWholeCyclesOfTheClock) {
  EXPECT_EQ(event_queue.cycle_after(sc_core::sc_time(3, sc_core::SC_NS)), 3u);
  EXPECT_EQ(event_queue.cycle_after(sc_core::sc_time(3001, sc_core::SC_PS)), 4u);
  EXPECT_EQ(event_queue.delay_until(7), sc_core::sc_time(7, sc_core::SC_NS));
}

}  // namespace event_queue_test
