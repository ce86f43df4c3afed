#include "model/time/agenda.hpp"

#include <random>

#include "tests/support/systemc_fixture.hpp"

namespace {

using model::Cycles;

class Agenda : public test_support::SystemCFixture {
 protected:
  model::ClockDomain clock{1e9};
  model::Agenda agenda{"agenda", clock};
  std::vector<std::pair<Cycles, int>> done;  ///< when, what

  void ask(Cycles cycle, int what) {
    agenda.at(cycle, [this, what] { done.emplace_back(agenda.now(), what); });
  }
};

TEST_F(Agenda, DoesWhatIsAskedInItsCycleAndInTheOrderOfAsking) {
  ask(20, 0);
  ask(10, 1);
  ask(100000, 2);
  ask(20, 3);
  ask(10, 4);
  sc_core::sc_start();
  EXPECT_EQ(done, (std::vector<std::pair<Cycles, int>>{{10, 1}, {10, 4}, {20, 0}, {20, 3}, {100000, 2}}));
}

TEST_F(Agenda, TasksAskForMoreInTheSameCycleAndLater) {
  agenda.at(5, [this] {
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

TEST_F(Agenda, NearAndFarEntriesOfOneCycleKeepTheirOrder) {
  ask(1000, 0);                              // far
  agenda.at(900, [this] { ask(1000, 1); });  // near by then
  ask(1000, 2);                              // far
  sc_core::sc_start();
  EXPECT_EQ(done, (std::vector<std::pair<Cycles, int>>{{1000, 0}, {1000, 2}, {1000, 1}}));
}

TEST_F(Agenda, ManyTasksComeInOrder) {
  std::mt19937 random(1);
  int asked = 0;
  for (; asked < 300; ++asked) ask(Cycles(random() % 2000), asked);
  agenda.at(700, [&] {
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

TEST_F(Agenda, SomethingSoonerWakesItSooner) {
  ask(500, 0);
  sc_core::sc_start(sc_core::sc_time(100, sc_core::SC_NS));
  ask(200, 1);
  ask(50, 2);
  sc_core::sc_start();
  EXPECT_EQ(done, (std::vector<std::pair<Cycles, int>>{{100, 2}, {200, 1}, {500, 0}}));
}

TEST_F(Agenda, WaitsForWholeCyclesOfTheClock) {
  EXPECT_EQ(agenda.cycle_after(sc_core::sc_time(3, sc_core::SC_NS)), 3u);
  EXPECT_EQ(agenda.cycle_after(sc_core::sc_time(3001, sc_core::SC_PS)), 4u);
  EXPECT_EQ(agenda.delay_until(7), sc_core::sc_time(7, sc_core::SC_NS));
}

}  // namespace
