#include "model/pio/pio_queue.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace pio_queue_test {

using cn::Direction;
using model::Cycles;
using model::PioArbitration;
using model::PioQueue;

constexpr Direction kRead = Direction::mono_to_poly;
constexpr Direction kWrite = Direction::poly_to_mono;

struct Arrival {
  Direction direction;
  Cycles enqueued;
  Cycles service;
};
struct Served {
  std::uint64_t id;
  Cycles start;
  bool operator==(const Served& other) const { return id == other.id && start == other.start; }
  friend std::ostream& operator<<(std::ostream& out, const Served& s) {
    return out << "request " << s.id << " at " << s.start;
  }
};

/// Offers the requests in order. With `settle_every_cycle`, starts what is due before and at each cycle, as a
/// control unit that asks often would; otherwise only before the next arrival.
std::vector<Served> serve(PioArbitration arbitration, const std::vector<Arrival>& arrivals,
                          bool settle_every_cycle = false) {
  PioQueue queue(arbitration, 8);
  std::vector<Served> served;
  const auto settle = [&](Cycles now) {
    for (auto next = queue.next(); next && next->cycle <= now; next = queue.next()) {
      served.push_back({next->entry.id, next->cycle});
      queue.begin(*next, next->cycle + arrivals[next->entry.id].service);
    }
  };
  Cycles now = 0;
  for (std::size_t id = 0; id < arrivals.size(); ++id) {
    const Cycles arrival = arrivals[id].enqueued;
    for (; settle_every_cycle && now <= arrival; ++now) settle(now);
    if (arrival > 0) settle(arrival - 1);
    queue.push({id, arrivals[id].direction, arrival, 0});
  }
  settle(~Cycles{0});
  EXPECT_EQ(queue.waiting(), 0);
  return served;
}

const std::vector<Arrival> kMixed = {{kWrite, 10, 100}, {kWrite, 20, 50}, {kRead, 30, 40},
                                     {kRead, 40, 40},   {kWrite, 60, 50}, {kRead, 150, 10}};

TEST(PioQueue, StrictFifoServesInOrderOfArrival) {
  const std::vector<Served> expected = {{0, 10}, {1, 110}, {2, 160}, {3, 200}, {4, 240}, {5, 290}};
  EXPECT_EQ(serve(PioArbitration::strict_fifo, kMixed), expected);
}

TEST(PioQueue, ReadsOvertakeWritesWhenTheEngineGetsFree) {
  // At 110 reads 2 and 3 wait; at 190 read 5 does; then the writes by age.
  const std::vector<Served> expected = {{0, 10}, {2, 110}, {3, 150}, {5, 190}, {1, 200}, {4, 250}};
  EXPECT_EQ(serve(PioArbitration::reads_overtake_writes, kMixed), expected);
}

TEST(PioQueue, QueuesPerDirectionRunSideBySide) {
  const std::vector<Served> expected = {{0, 10}, {2, 30}, {3, 70}, {1, 110}, {5, 150}, {4, 160}};
  EXPECT_EQ(serve(PioArbitration::queue_per_direction, kMixed), expected);
}

TEST(PioQueue, OlderOfTwoThatStartTogetherGoesFirst) {
  const std::vector<Served> expected = {{0, 10}, {1, 10}};
  EXPECT_EQ(serve(PioArbitration::queue_per_direction, {{kWrite, 10, 5}, {kRead, 10, 5}}), expected);
}

TEST(PioQueue, ReadQueuedInTheVeryCycleComesTooLate) {
  const std::vector<Served> too_late = {{0, 0}, {1, 100}, {2, 200}};
  EXPECT_EQ(
      serve(PioArbitration::reads_overtake_writes, {{kRead, 0, 100}, {kWrite, 50, 100}, {kRead, 100, 10}}),
      too_late);
  const std::vector<Served> in_time = {{0, 0}, {2, 100}, {1, 110}};
  EXPECT_EQ(
      serve(PioArbitration::reads_overtake_writes, {{kRead, 0, 100}, {kWrite, 50, 100}, {kRead, 99, 10}}),
      in_time);
}

TEST(PioQueue, IdleEngineStartsAtArrival) {
  for (const auto arbitration : {PioArbitration::strict_fifo, PioArbitration::reads_overtake_writes,
                                 PioArbitration::queue_per_direction}) {
    const std::vector<Served> expected = {{0, 5}, {1, 500}};
    EXPECT_EQ(serve(arbitration, {{kWrite, 5, 10}, {kRead, 500, 10}}), expected);
  }
}

TEST(PioQueue, DecisionsDoNotDependOnHowOftenTheEngineIsAsked) {
  const std::vector<Arrival> simultaneous = {{kWrite, 10, 10}, {kRead, 10, 10},  {kWrite, 20, 10},
                                             {kRead, 20, 10},  {kWrite, 30, 10}, {kWrite, 30, 10},
                                             {kRead, 70, 10},  {kRead, 71, 10}};
  for (const auto arbitration : {PioArbitration::strict_fifo, PioArbitration::reads_overtake_writes,
                                 PioArbitration::queue_per_direction}) {
    EXPECT_EQ(serve(arbitration, kMixed, true), serve(arbitration, kMixed));
    EXPECT_EQ(serve(arbitration, simultaneous, true), serve(arbitration, simultaneous));
  }
}

TEST(PioQueue, FullCountsWaitingRequestsOfTheSameQueue) {
  PioQueue shared(PioArbitration::strict_fifo, 2);
  shared.push({0, kRead, 0, 0});
  shared.push({1, kWrite, 0, 0});
  EXPECT_TRUE(shared.full(kRead));
  EXPECT_TRUE(shared.full(kWrite));
  shared.begin(*shared.next(), 50);
  EXPECT_FALSE(shared.full(kRead));
  EXPECT_EQ(shared.waiting(), 1);
  EXPECT_EQ(shared.next()->cycle, 50u);

  PioQueue split(PioArbitration::queue_per_direction, 2);
  split.push({0, kRead, 0, 0});
  split.push({1, kRead, 0, 0});
  EXPECT_TRUE(split.full(kRead));
  EXPECT_FALSE(split.full(kWrite));
  EXPECT_EQ(split.engine_of(kRead), 0);
  EXPECT_EQ(split.engine_of(kWrite), 1);
}

TEST(PioQueue, NothingNextWhenEmpty) {
  EXPECT_FALSE(PioQueue(PioArbitration::strict_fifo, 1).next().has_value());
}

}  // namespace pio_queue_test
