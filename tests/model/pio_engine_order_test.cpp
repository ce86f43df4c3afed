#include "model/pio/pio_engine.hpp"

#include "firmware/cn/machine.hpp"
#include "tests/support/pio_bench.hpp"

namespace pio_engine_order_test {

using cn::LaneMask;
using cn::MonoPlaces;
using model::Cycles;
using model::PioArbitration;

class PioEngineOrder : public test_support::PioBench {};

TEST_F(PioEngineOrder, StrictFifo) {
  build(test_support::chip_with(PioArbitration::strict_fifo));
  enqueue_read(1000, 0);
  enqueue_write(1001, 1);
  enqueue_read(1002, 2);
  EXPECT_EQ(signal(0), 1212u);
  EXPECT_EQ(signal(1), 1424u);
  EXPECT_EQ(signal(2), 1636u);
  EXPECT_EQ(engine->statistics().queue_wait_cycles, 211u + 422u);
  EXPECT_EQ(engine->statistics().max_queue_depth, 2);
}

TEST_F(PioEngineOrder, ReadsOvertakeWrites) {
  build(test_support::chip_with(PioArbitration::reads_overtake_writes));
  enqueue_read(1000, 0);
  enqueue_write(1001, 1);
  enqueue_read(1002, 2);
  EXPECT_EQ(signal(0), 1212u);
  EXPECT_EQ(signal(2), 1424u);
  EXPECT_EQ(signal(1), 1636u);
}

TEST_F(PioEngineOrder, QueuePerDirection) {
  build(test_support::chip_with(PioArbitration::queue_per_direction));
  enqueue_read(1000, 0);
  enqueue_write(1001, 1);
  enqueue_read(1002, 2);
  EXPECT_EQ(signal(0), 1212u);
  EXPECT_EQ(signal(1), 1213u);
  EXPECT_EQ(signal(2), 1424u);
  EXPECT_EQ(ddr->statistics().turn_rounds, 2u);
}

TEST_F(PioEngineOrder, DirectionsShareTheMemory) {
  auto config = test_support::chip_with(PioArbitration::queue_per_direction);
  config.ddr.bytes_per_cycle = 1;
  build(config);
  enqueue_read(1000, 0);  // data bus 1146..1402
  enqueue_write(1001, 1);
  EXPECT_EQ(signal(0), 1412u);
  EXPECT_EQ(signal(1), 1662u);  // turn-round of 4, then 1406..1662
}

TEST_F(PioEngineOrder, FullQueueHoldsUpTheControlUnit) {
  build(test_support::test_chip());
  EXPECT_EQ(enqueue_read(1000, 0), 1000u);
  EXPECT_EQ(enqueue_read(1001, 1), 1001u);
  EXPECT_EQ(enqueue_read(1002, 2), 1002u);
  EXPECT_EQ(enqueue_read(1003, 3), 1212u);  // when request 1 starts
  EXPECT_EQ(enqueue_read(1300, 4), 1424u);  // when request 2 starts
  EXPECT_EQ(signal(3), 1848u);
  EXPECT_EQ(signal(4), 2060u);
  EXPECT_EQ(engine->statistics().blocked_cycles, 209u + 124u);
}

TEST_F(PioEngineOrder, FullQueueOfOneDirectionDoesNotHoldUpTheOther) {
  build(test_support::chip_with(PioArbitration::queue_per_direction));
  for (int i = 0; i < 3; ++i) enqueue_read(1000, 0);
  EXPECT_EQ(enqueue_write(1001, 1), 1001u);
  EXPECT_EQ(enqueue_read(1002, 0), 1212u);
}

TEST_F(PioEngineOrder, SettleStartsWhatIsDueAndNoMore) {
  build(test_support::test_chip());
  enqueue_read(1000, 0);
  enqueue_read(1001, 1);
  enqueue_read(1002, 2);
  engine->settle(1211);
  EXPECT_EQ(semaphores.signals.count(1), 0u);
  engine->settle(1212);
  EXPECT_EQ(semaphores.signals[1], std::vector<Cycles>{1424});
  EXPECT_EQ(semaphores.signals.count(2), 0u);
  EXPECT_TRUE(engine->serve_next());
  EXPECT_EQ(semaphores.signals[2], std::vector<Cycles>{1636});
  EXPECT_FALSE(engine->serve_next());
}

class PioEngineSettled : public PioEngineOrder, public testing::WithParamInterface<PioArbitration> {};

TEST_P(PioEngineSettled, ResultDoesNotDependOnHowOftenItIsSettled) {
  auto config = test_support::chip_with(GetParam());
  config.pio.queue_depth = 4;
  config.ddr.refresh_interval_cycles = 700;
  config.ddr.refresh_cycles = 30;
  build(config);
  const auto run = [&](Cycles begin, bool settle_often) {
    semaphores.signals.clear();
    Cycles now = begin;
    for (int i = 0; i < 40; ++i) {
      const Cycles next = now + Cycles(i * 37 % 190);
      if (settle_often)
        for (; now < next; ++now) engine->settle(now);
      if (settle_often) engine->settle(next);
      now = i % 3 == 0 ? enqueue_write(next, i) : enqueue_read(next, i);
    }
    serve_all();
    std::map<int, Cycles> signals;
    for (const auto& [semaphore, at] : semaphores.signals) signals[semaphore] = at.back() - begin;
    return signals;
  };
  run(0, false);  // leaves the same row open and the same bus direction to both
  const auto seldom = run(70000, false);
  const auto often = run(140000, true);
  EXPECT_EQ(seldom.size(), 40u);
  EXPECT_EQ(seldom, often);
}

INSTANTIATE_TEST_SUITE_P(Arbitrations, PioEngineSettled,
                         testing::Values(PioArbitration::strict_fifo, PioArbitration::reads_overtake_writes,
                                         PioArbitration::queue_per_direction));

TEST_F(PioEngineOrder, WordsMoveLinearlyAfterSetup) {
  build(test_support::test_chip());
  enqueue_read(1000, 0);  // 32 words in 1100..1212
  EXPECT_EQ(engine->words_moved_before(1100), 0u);
  EXPECT_EQ(engine->words_moved_before(1156), 16u);
  EXPECT_EQ(engine->words_moved_before(1211), 31u);
  EXPECT_EQ(engine->words_moved_before(1212), 32u);
  enqueue_write(1300, 1);
  EXPECT_EQ(engine->words_moved_before(1456), 48u);
  EXPECT_EQ(engine->words_moved_before(1156), 16u);
}

TEST_F(PioEngineOrder, StartInThePastIsCounted) {
  build(test_support::test_chip());
  enqueue_read(100, 0);
  enqueue_read(101, 1);  // starts at 312
  sc_core::sc_start(sc_core::sc_time(1000, sc_core::SC_NS));
  serve_all();
  EXPECT_EQ(engine->statistics().late_starts, 1u);
  // Memory side not before 1000: at the DDR 1006, hit: data 1026..1042, link 1026..1058, there at 1064.
  EXPECT_EQ(semaphores.signals[1], std::vector<Cycles>{1068});
  enqueue_read(2000, 2);
  EXPECT_EQ(signal(2), 2212u);
  EXPECT_EQ(engine->statistics().late_starts, 1u);
}

TEST_F(PioEngineOrder, ObserverSeesEveryRequestWithItsTimes) {
  struct Observer : model::PioObserver {
    void started(const model::PioEvent& event) override {
      EXPECT_EQ(event.finished, 0u);
      ++starts;
    }
    void finished(const model::PioEvent& event) override { events.push_back(event); }
    int starts = 0;
    std::vector<model::PioEvent> events;
  } observer;
  build(test_support::test_chip());
  engine->set_observer(&observer);
  enqueue_read(1000, 7);
  engine->enqueue(write(MonoPlaces::array(0, 32), 32, LaneMask::first(3), 9), 1001);
  enqueue_read(1002, 8);
  serve_all();
  ASSERT_EQ(observer.events.size(), 3u);
  EXPECT_EQ(observer.starts, 3);
  const model::PioEvent& event = observer.events[1];
  EXPECT_EQ(event.id, 1u);
  EXPECT_EQ(event.direction, cn::Direction::poly_to_mono);
  EXPECT_EQ(event.bytes, 96u);
  EXPECT_EQ(event.pes, 3);
  EXPECT_EQ(event.enqueued, 1001u);
  EXPECT_EQ(event.started, 1212u);
  EXPECT_EQ(event.finished, 1358u);  // first data 1326, at the DDR 1332, hit: 1352..1358; PE side ends 1354
  EXPECT_EQ(event.semaphore, 9);
  EXPECT_EQ(event.queue_depth, 1);
}

}  // namespace pio_engine_order_test
