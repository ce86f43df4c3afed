// The PIO path in four-phase transactions: exact cycles, protocol, bounds, memory management.

#include <cstdlib>
#include <new>

#include "firmware/cn/machine.hpp"
#include "tests/support/pio_bench.hpp"

namespace at_pio_test {

std::size_t allocations = 0;

}  // namespace at_pio_test

// Not inlined: the compiler would see malloc meet delete.
[[gnu::noinline]] void* operator new(std::size_t bytes) {
  ++at_pio_test::allocations;
  if (void* const memory = std::malloc(bytes)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace at_pio_test {

using cn::LaneMask;
using cn::MonoPlaces;
using model::Cycles;
using model::PioArbitration;
using test_support::kAll;
using test_support::kPes;
using test_support::test_chip;

class AtPio : public test_support::PioBench {
 protected:
  void build_at(const model::ChipConfig& chip) { build(chip, model::TimingStyle::approximately_timed); }
  /// When a single transfer's semaphore is signalled.
  Cycles time_of(const cn::Transfer& transfer, Cycles now = 1000) {
    Cycles at = 0;
    run([&] {
      EXPECT_EQ(engine->enqueue(transfer, now), now);
      at = signal(transfer.done.index);
    });
    return at;
  }
};

TEST_F(AtPio, ReadEndsWhenTheLastPacketHasBeenAskedForAndTheDataAreInTheirPes) {
  build_at(test_chip());
  // The last packet, of PEs 6 and 7, leaves after the address phase of PE 6, 1170; at the DDR 1176, hit: data
  // 1196..1200, link 1196..1204, there at 1210; then 4 cycles for each PE. (Loosely timed 1212: all addresses
  // are known at once.)
  EXPECT_EQ(time_of(read(MonoPlaces::array(0, 32), 32, kAll)), 1218u);
  EXPECT_EQ(at_engine.transactions(), 4u);  // packets of 64 bytes
  EXPECT_EQ(at_memory.transactions(), 4u);
  EXPECT_EQ(engine->statistics().setup_cycles, 100u);
  EXPECT_EQ(engine->statistics().pe_cycles, 112u);
  EXPECT_EQ(engine->statistics().memory_wait_cycles, 6u);
}

TEST_F(AtPio, LongReadEndsWithThePeSide) {
  auto config = test_chip(96);
  config.pio.setup_cycles = 150;
  config.pio.per_pe_cycles = 16;
  build_at(config);
  // As loosely timed, 150 + 96 x 26 = 2646 cycles (docs/csx600.md, section 2); latency hides behind PEs.
  EXPECT_EQ(time_of(read(MonoPlaces::array(0, 80), 80, LaneMask::first(96))), 3646u);
  EXPECT_EQ(engine->statistics().memory_wait_cycles, 0u);
}

TEST_F(AtPio, ReadOfOnePePaysTheWholeLatency) {
  build_at(test_chip());
  // Address at 1110, at the DDR 1116, data 1146..1148, link 1146..1150, there at 1156, then 4 into the PE.
  EXPECT_EQ(time_of(read(MonoPlaces::array(0, 32), 32, LaneMask::first(1))), 1160u);
  EXPECT_EQ(engine->statistics().memory_wait_cycles, 46u);
}

TEST_F(AtPio, PostedWriteDoesNotWaitForTheMemory) {
  build_at(test_chip());
  EXPECT_EQ(time_of(write(MonoPlaces::array(0, 32), 32, LaneMask::first(1))), 1114u);
  EXPECT_EQ(ddr->statistics().bytes_written, 32u);
}

TEST_F(AtPio, ContiguousWriteEndsWithThePeSide) {
  build_at(test_chip());
  EXPECT_EQ(time_of(write(MonoPlaces::array(0, 32), 32, kAll)), 1212u);
}

TEST_F(AtPio, DataMoveBothWays) {
  build_at(test_chip());
  fill_memories(8192);
  run([&] {
    engine->enqueue(read(MonoPlaces::array(256, 32), 32, kAll, 0), 0);
    engine->enqueue(write(MonoPlaces::array(4096, 32), 32, kAll, 1), 0);
    serve_all();
  });
  for (int pe = 0; pe < kPes; ++pe) EXPECT_EQ(poly_word(pe, 8), 0xd000000u + 256 + 32 * unsigned(pe) + 8);
  for (std::uint64_t i = 0; i < 256; i += 8) EXPECT_EQ(mono_word(4096 + i), 0xd000000u + 256 + i);
}

TEST_F(AtPio, WriteOnTheWayDoesNotBringBackWhatALaterOneReplaced) {
  auto config = test_chip();
  config.ddr.page_hit_cycles = config.ddr.page_miss_cycles = 2000;  // on the way for long
  build_at(config);
  run([&] {
    poly->words()[0] = 1;
    engine->enqueue(write(MonoPlaces::array(64, 8), 8, LaneMask::first(1), 0), 0);
    engine->settle(500);  // it has left
    poly->words()[0] = 2;
    engine->enqueue(write(MonoPlaces::array(64, 8), 8, LaneMask::first(1), 1), 500);
    serve_all();
  });
  EXPECT_EQ(mono_word(64), 2u);
}

TEST_F(AtPio, SlowMemoryPushesWritesBack) {
  auto config = test_chip();
  config.ddr.bytes_per_cycle = 1;
  config.pio.outstanding_packets = 1;
  build_at(config);
  // A packet needs 64 cycles of the port and of the data bus; the last leaves when the one before has been
  // taken.
  const Cycles end = time_of(write(MonoPlaces::array(0, 32), 32, kAll));
  EXPECT_GT(end, 1212u + 150);
  EXPECT_EQ(at_engine.most_active(), 1u);
}

TEST_F(AtPio, FullMemoryEndsRequestsLate) {
  auto config = test_chip();
  config.ddr.queue_transactions = 1;
  build_at(config);
  cn::MonoAddress by_pe[kPes];
  for (std::uint64_t pe = 0; pe < kPes; ++pe) by_pe[pe] = 2048 * pe;
  // Each row of the bank is opened anew: 20 for the address phase, 30 + 2 in the memory, one after the other.
  time_of(read(MonoPlaces::each(by_pe), 32, kAll));
  EXPECT_EQ(at_memory.most_active(), 1u);
  EXPECT_GT(engine->statistics().memory_wait_cycles, 8u * 32 - 150);
}

TEST_F(AtPio, PacketsOnTheWayAreBounded) {
  auto config = test_chip();
  config.pio.outstanding_packets = 3;
  config.ddr.page_hit_cycles = config.ddr.page_miss_cycles = 500;
  build_at(config);
  time_of(read(MonoPlaces::array(0, 128), 128, kAll));
  EXPECT_EQ(at_engine.most_active(), 3u);
}

TEST_F(AtPio, FirmwareWaitsBeforeAFullQueue) {
  build_at(test_chip());
  run([&] {
    EXPECT_EQ(enqueue_read(1000, 0), 1000u);
    EXPECT_EQ(enqueue_read(1001, 1), 1001u);
    EXPECT_EQ(enqueue_read(1002, 2), 1002u);
    EXPECT_EQ(enqueue_read(1003, 3), 1218u);  // when request 1 starts
    EXPECT_EQ(sc_core::sc_time_stamp(), sc_core::sc_time(1218, sc_core::SC_NS));
    EXPECT_EQ(signal(3), 1000u + 4 * 218);
  });
}

TEST_F(AtPio, ReadsOvertakeWrites) {
  build_at(test_support::chip_with(PioArbitration::reads_overtake_writes));
  run([&] {
    enqueue_read(1000, 0);
    enqueue_write(1001, 1);
    enqueue_read(1002, 2);
    EXPECT_EQ(signal(0), 1218u);
    EXPECT_EQ(signal(2), 1436u);
    EXPECT_EQ(signal(1), 1648u);
  });
}

TEST_F(AtPio, QueuesOfTwoDirectionsRunSideBySide) {
  build_at(test_support::chip_with(PioArbitration::queue_per_direction));
  run([&] {
    enqueue_read(1000, 0);
    enqueue_write(1001, 1);
    enqueue_read(1002, 2);
    EXPECT_EQ(signal(0), 1218u);
    EXPECT_EQ(signal(1), 1213u);
    EXPECT_EQ(signal(2), 1436u);
  });
}

TEST_F(AtPio, NoTransactionAllocatesOnceAllPayloadsExist) {
  auto config = test_chip();
  config.ddr.refresh_interval_cycles = 700;
  config.ddr.refresh_cycles = 30;
  build_at(config);
  run([&] {
    Cycles now = 0;
    const auto requests = [&](int count) {
      for (int i = 0; i < count; ++i)
        now =
            i % 3 == 0
                ? engine->enqueue(write(MonoPlaces::array(64 * std::uint64_t(i % 40), 32), 32, kAll, -1), now)
                : engine->enqueue(read(MonoPlaces::array(96 * std::uint64_t(i % 40), 96), 32, kAll, -1), now);
      serve_all();
      now = event_queue->now();
    };
    requests(2000);
    const std::size_t before = allocations;
    const std::size_t transactions = at_engine.transactions() + at_memory.transactions();
    requests(200);
    // The checkers themselves allocate one node of a map for each transaction they see; nothing of the model
    // may grow with the number of transactions.
    const std::size_t seen = at_engine.transactions() + at_memory.transactions() - transactions;
    EXPECT_LT(allocations - before, seen + 10);
    EXPECT_GT(seen, 800u);
  });
}

/// Answers every read with an error.
class BrokenMemory : public sc_core::sc_module {
 public:
  tlm_utils::simple_target_socket<BrokenMemory> socket{"socket"};
  explicit BrokenMemory(const sc_core::sc_module_name& name) : sc_module(name) {
    socket.register_b_transport(this, &BrokenMemory::b_transport);
    socket.register_transport_dbg(this, &BrokenMemory::transport_dbg);
  }

 private:
  void b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time&) {
    transaction.set_response_status(tlm::TLM_GENERIC_ERROR_RESPONSE);
  }
  unsigned int transport_dbg(tlm::tlm_generic_payload& transaction) { return transaction.get_data_length(); }
};

TEST_F(AtPio, AnErrorOfTheMemoryReachesTheFirmware) {
  event_queue = std::make_unique<model::EventQueue>("event_queue", clock);
  prepare(test_chip());
  BrokenMemory broken("broken");
  network->ddr_socket.bind(at_memory.in);
  at_memory.out.bind(broken.socket);
  run([&] {
    engine->enqueue(read(MonoPlaces::array(64, 64), 64, LaneMask::first(1), 0), 0);
    try {
      serve_all();
      FAIL() << "no fault";
    } catch (const cn::MachineFault& fault) {
      EXPECT_STREQ(fault.what(),
                   "PIO transaction at mono address 64: memory answered TLM_GENERIC_ERROR_RESPONSE");
    }
  });
}

}  // namespace at_pio_test
