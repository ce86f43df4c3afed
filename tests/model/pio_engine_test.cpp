#include "model/pio/pio_engine.hpp"

#include "firmware/cn/machine.hpp"
#include "tests/support/pio_bench.hpp"

namespace pio_engine_test {

using cn::LaneMask;
using cn::MonoPlaces;
using model::Cycles;

using test_support::kAll;
using test_support::kPes;

class PioEngine : public test_support::PioBench {};

TEST_F(PioEngine, ContiguousReadEndsWithThePeSide) {
  build(test_support::test_chip());
  EXPECT_EQ(engine->enqueue(read(MonoPlaces::array(0, 32), 32, kAll), 1000), 1000u);
  // Memory: first address at 1110, at the DDR 1116, data 1146..1162, link 1146..1178, there at 1184.
  EXPECT_EQ(signal(), 1212u);
  EXPECT_EQ(engine->statistics().setup_cycles, 100u);
  EXPECT_EQ(engine->statistics().pe_cycles, 112u);
  EXPECT_EQ(engine->statistics().memory_wait_cycles, 0u);
}

TEST_F(PioEngine, ReadOfOnePePaysTheWholeLatency) {
  build(test_support::test_chip());
  engine->enqueue(read(MonoPlaces::array(0, 32), 32, LaneMask::first(1)), 1000);
  // Data 1146..1148, link 1146..1150, there at 1156, then 4 cycles into the PE; its side alone would end at
  // 1114.
  EXPECT_EQ(signal(), 1160u);
  EXPECT_EQ(engine->statistics().memory_wait_cycles, 46u);
  EXPECT_EQ(engine->statistics().busy_cycles(), 160u);
}

TEST_F(PioEngine, WriteIsPosted) {
  build(test_support::test_chip());
  engine->enqueue(write(MonoPlaces::array(0, 32), 32, LaneMask::first(1)), 1000);
  // The PE's data leave at 1114; at the DDR 1120, data 1150..1152 have been taken.
  EXPECT_EQ(signal(), 1152u);
  EXPECT_EQ(ddr->statistics().bytes_written, 32u);
}

TEST_F(PioEngine, ContiguousWriteEndsWithThePeSide) {
  build(test_support::test_chip());
  enqueue_write(1000, 0);
  EXPECT_EQ(signal(), 1212u);  // memory 1150..1166
  EXPECT_EQ(engine->statistics().memory_wait_cycles, 0u);
}

TEST_F(PioEngine, SlowMemoryHoldsUpReads) {
  auto config = test_support::test_chip();
  config.ddr.bytes_per_cycle = 1;
  build(config);
  enqueue_read(1000, 0);
  // At the DDR 1116, data 1146..1402, there at 1408, last PE's 4 cycles.
  EXPECT_EQ(signal(), 1412u);
  EXPECT_EQ(engine->statistics().memory_wait_cycles, 200u);
}

TEST_F(PioEngine, SlowMemoryPushesWritesBack) {
  auto config = test_support::test_chip();
  config.ddr.bytes_per_cycle = 1;
  build(config);
  enqueue_write(1000, 0);
  // First data at 1114, at the DDR 1120, 1150..1406.
  EXPECT_EQ(signal(), 1406u);
  EXPECT_EQ(engine->statistics().memory_wait_cycles, 194u);
}

TEST_F(PioEngine, GatherOverRowsOfOneBankWaitsForMemory) {
  build(test_support::test_chip());
  cn::MonoAddress by_pe[kPes];
  for (std::uint64_t pe = 0; pe < kPes; ++pe) by_pe[pe] = 2048 * pe;
  engine->enqueue(read(MonoPlaces::each(by_pe), 32, kAll), 1000);
  // At the DDR 1116; the first row's 2 cycles end at 1148, each further row costs 2 + (30 - 20) more: 1232.
  // Last byte there at 1238, then 4 cycles into the PE. The contiguous request needs 1212.
  EXPECT_EQ(signal(), 1242u);
  EXPECT_EQ(ddr->statistics().page_misses, 8u);
}

TEST_F(PioEngine, ScatterOverRowsOfOneBankWaitsForMemory) {
  build(test_support::test_chip());
  cn::MonoAddress by_pe[kPes];
  for (std::uint64_t pe = 0; pe < kPes; ++pe) by_pe[pe] = 2048 * pe;
  engine->enqueue(write(MonoPlaces::each(by_pe), 32, kAll), 1000);
  // At the DDR 1120, so 1150 + 2 + 7 x 12.
  EXPECT_EQ(signal(), 1236u);
}

TEST_F(PioEngine, MisalignedPiecesCostExtra) {
  build(test_support::test_chip());
  // 48-byte pieces in 64-byte packets: 2 of 4 cross. 100 + 8 x (10 + 6) + 4 x 5.
  engine->enqueue(read(MonoPlaces::array(0, 48), 48, kAll, 0), 1000);
  EXPECT_EQ(signal(0), 1248u);
  // 24 bytes at 4 + 64 pe: all off the 8-byte boundary. 100 + 8 x (10 + 3) + 8 x 5.
  engine->enqueue(read(MonoPlaces::array(4, 64), 24, kAll, 1), 2000);
  EXPECT_EQ(signal(1), 2244u);
  EXPECT_EQ(engine->statistics().pe_cycles, 148u + 144u);
}

TEST_F(PioEngine, ReferenceExampleOf96Pes) {
  auto config = test_support::test_chip(96);
  config.pio.setup_cycles = 150;
  config.pio.per_pe_cycles = 16;
  build(config);
  // docs/csx600.md, section 2: 80 B x 96 PEs = 150 + 96 x 26 = 2646 cycles.
  engine->enqueue(read(MonoPlaces::array(0, 80), 80, LaneMask::first(96), 0), 0);
  engine->enqueue(write(MonoPlaces::array(0, 80), 80, LaneMask::first(96), 1), 10000);
  EXPECT_EQ(signal(0), 2646u);
  EXPECT_EQ(signal(1), 12646u);
}

TEST_F(PioEngine, DisabledPesTakeNoPart) {
  build(test_support::test_chip());
  fill_memories(4096);
  LaneMask enabled;
  for (const int pe : {1, 2, 5}) enabled.set(pe, true);
  engine->enqueue(read(MonoPlaces::array(0, 32), 32, enabled), 1000);
  // PE side 1142. Runs of 64 and 32 bytes: data 1146..1150 and 1150..1152; link 12 cycles from 1146, there at
  // 1164; 4.
  EXPECT_EQ(signal(), 1168u);
  EXPECT_EQ(poly_word(1, 0), 0xd000000u + 32);
  EXPECT_EQ(poly_word(2, 24), 0xd000000u + 64 + 24);
  EXPECT_EQ(poly_word(0, 0), 0x5000000u);
  EXPECT_EQ(poly_word(6, 8), 0x5000000u + 8 + 6);
  EXPECT_EQ(engine->statistics().pes, 3u);
  EXPECT_EQ(engine->statistics().bytes_to_poly, 96u);
}

TEST_F(PioEngine, RequestWithoutAPeSignalsAtOnceEvenWhenTheQueueIsFull) {
  build(test_support::test_chip());
  for (int i = 0; i < 3; ++i) enqueue_read(1000, 5);
  EXPECT_EQ(engine->queue_depth(), 2);
  EXPECT_EQ(engine->enqueue(read(MonoPlaces::array(~std::uint64_t{0}, 8), 32, LaneMask()), 1001), 1001u);
  EXPECT_EQ(semaphores.signals[0], std::vector<Cycles>{1001});
  EXPECT_EQ(engine->enqueue(write(MonoPlaces::array(0, 0), 0, kAll, 1), 1002), 1002u);
  EXPECT_EQ(semaphores.signals[1], std::vector<Cycles>{1002});
  EXPECT_EQ(engine->statistics().empty_requests, 2u);
  serve_all();
  EXPECT_EQ(engine->statistics().requests_to_poly, 3u);
  EXPECT_EQ(engine->statistics().busy_cycles(), 3u * 212);
}

TEST_F(PioEngine, NobodyIsSignalledWithoutASemaphore) {
  build(test_support::test_chip());
  engine->enqueue(read(MonoPlaces::array(0, 32), 32, kAll, -1), 1000);
  EXPECT_FALSE(engine->serve_next());
  EXPECT_TRUE(semaphores.signals.empty());
}

TEST_F(PioEngine, EqualAddressesAreFetchedOnceWhenAsked) {
  auto config = test_support::test_chip();
  config.pio.consolidate_equal_addresses = true;
  build(config);
  fill_memories(4096);
  engine->enqueue(read(MonoPlaces::array(64, 0), 32, kAll), 1000);
  EXPECT_EQ(signal(), 1160u);  // as for one PE
  for (int pe = 0; pe < kPes; ++pe) EXPECT_EQ(poly_word(pe, 8), 0xd000000u + 72);
  EXPECT_EQ(ddr->statistics().bytes_read, 32u);
  EXPECT_EQ(engine->statistics().bytes_to_poly, 256u);
}

TEST_F(PioEngine, EqualAddressesAreFetchedByEachPeOtherwise) {
  build(test_support::test_chip());
  engine->enqueue(read(MonoPlaces::array(64, 0), 32, kAll), 1000);
  EXPECT_EQ(signal(), 1212u);
  EXPECT_EQ(ddr->statistics().bytes_read, 256u);
}

TEST_F(PioEngine, CyclesAreAbsoluteAtAnySimulationTime) {
  build(test_support::test_chip());
  sc_core::sc_start(sc_core::sc_time(900, sc_core::SC_NS));
  engine->enqueue(read(MonoPlaces::array(0, 32), 32, LaneMask::first(1)), 1000);
  EXPECT_EQ(signal(), 1160u);
}

TEST_F(PioEngine, SramPortsAreBooked) {
  build(test_support::test_chip());
  enqueue_read(0, 0);
  engine->enqueue(write(MonoPlaces::array(0, 32), 32, LaneMask::first(3), 1), 1000);
  EXPECT_EQ(sram->statistics().words_in, 32u);
  EXPECT_EQ(sram->statistics().words_out, 12u);
}

}  // namespace pio_engine_test
