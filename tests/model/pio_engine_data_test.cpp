#include "model/pio/pio_engine.hpp"

#include "firmware/cn/machine.hpp"
#include "tests/support/pio_bench.hpp"

namespace pio_engine_data_test {

using cn::LaneMask;
using cn::MonoPlaces;
using model::Cycles;
using model::PioArbitration;

using test_support::kAll;
using test_support::kPes;

class PioEngineData : public test_support::PioBench {};

TEST_F(PioEngineData, GatherAndScatterMoveEachPesPiece) {
  build(test_support::test_chip());
  fill_memories(1 << 16);
  const cn::MonoAddress from[kPes] = {800, 0, 4096, 8, 16384, 1600, 32768, 24};
  engine->enqueue(read(MonoPlaces::each(from), 16, kAll, 0), 0);
  for (int pe = 0; pe < kPes; ++pe) {
    EXPECT_EQ(poly_word(pe, 0), 0xd000000 + from[pe]) << pe;
    EXPECT_EQ(poly_word(pe, 8), 0xd000000 + from[pe] + 8) << pe;
  }
  cn::Transfer back = write(MonoPlaces::array(40960, 24), 8, kAll, 1);
  back.poly.offset_bytes = 8;
  engine->enqueue(back, 10);
  for (std::uint64_t pe = 0; pe < kPes; ++pe) {
    EXPECT_EQ(mono_word(40960 + 24 * pe), 0xd000000 + from[pe] + 8) << pe;
    EXPECT_EQ(mono_word(40968 + 24 * pe), 0xd000000 + 40968 + 24 * pe) << pe;  // between pieces
  }
}

TEST_F(PioEngineData, ScatterMayOverwriteTheTableThatDescribesIt) {
  build(test_support::test_chip(16));
  fill_memories(4096);
  for (std::uint64_t pe = 0; pe < 8; ++pe) {
    mono_word(8 * pe) = 64 + 8 * pe;  // where the addresses of PEs 8 to 15 are
    mono_word(64 + 8 * pe) = 1024 + 8 * pe;
  }
  engine->enqueue(write(MonoPlaces::each(&mono_word(0)), 8, cn::LaneMask::first(16)), 0);
  for (std::uint64_t pe = 0; pe < 8; ++pe) {
    EXPECT_EQ(mono_word(64 + 8 * pe), 0x5000000 + pe);
    EXPECT_EQ(mono_word(1024 + 8 * pe), 0x5000008 + pe);
  }
}

TEST_F(PioEngineData, PieceOutsideMonoMemoryIsAFaultBeforeAnythingMoves) {
  build(test_support::test_chip());
  fill_memories(4096);
  cn::MonoAddress to[kPes] = {0, 8, 16, 1048560, 32, 40, 48, 1048569};
  const auto message = [&](const cn::Transfer& transfer) -> std::string {
    try {
      engine->enqueue(transfer, 0);
    } catch (const cn::MachineFault& fault) {
      return fault.what();
    }
    return "accepted";
  };
  EXPECT_EQ(
      message(write(MonoPlaces::each(to), 24, kAll, 3)),
      "PIO request 0 (poly to mono, semaphore 3): PE 3 addresses 24 bytes at 0xffff0, mono memory is 0x0 to "
      "0xfffff");
  EXPECT_EQ(mono_word(0), 0xd000000u);
  EXPECT_EQ(
      message(read(MonoPlaces::array(1048576 - 7 * 32, 32), 32, kAll, 3)),
      "PIO request 0 (mono to poly, semaphore 3): PE 7 addresses 32 bytes at 0x100000, mono memory is 0x0 to "
      "0xfffff");
  EXPECT_EQ(message(read(MonoPlaces::array(0, ~std::uint64_t{0} - 7), 8, kAll, 3)),
            "PIO request 0 (mono to poly, semaphore 3): PE 1 addresses 8 bytes at 0xfffffffffffffff8, mono "
            "memory is "
            "0x0 to 0xfffff");
  EXPECT_EQ(message(read(MonoPlaces::array(0, 0x2492492492492493), 8, kAll, 3)),  // 7 strides wrap round to 5
            "PIO request 0 (mono to poly, semaphore 3): PE 1 addresses 8 bytes at 0x2492492492492493, mono "
            "memory is "
            "0x0 to 0xfffff");
  cn::Transfer beyond_sram = read(MonoPlaces::array(0, 32), 32, kAll, 3);
  beyond_sram.poly.offset_bytes = 1000;
  EXPECT_EQ(
      message(beyond_sram),
      "PIO request 0 (mono to poly, semaphore 3): 32 bytes at poly offset 1000, a PE's SRAM is 0 to 1023");
  EXPECT_EQ(engine->queue_depth(), 0);
  LaneMask others = kAll;
  others.set(3, false);
  others.set(7, false);
  EXPECT_EQ(message(write(MonoPlaces::each(to), 24, others, 3)),
            "accepted");  // disabled PEs may point anywhere
  EXPECT_EQ(message(read(MonoPlaces::array(1048576 - 7 * 32, 32), 32, LaneMask::first(7), 3)), "accepted");
}

TEST_F(PioEngineData, MinimalMemoryGetsOneTransactionARun) {
  build_with_minimal_memory(test_support::test_chip(), 100);
  fill_memories(1 << 16);
  cn::MonoAddress by_pe[kPes];
  for (std::uint64_t pe = 0; pe < kPes; ++pe) by_pe[pe] = 2048 * pe;
  engine->enqueue(read(MonoPlaces::each(by_pe), 32, kAll), 1000);
  // Requests leave from 1110 on, one a cycle; answers at 1216 + k, sent since 1214 + k; links of 4 cycles
  // each make 1214 + 8 x 4 = 1246, there at 1252, then 4 cycles into the PE.
  EXPECT_EQ(signal(), 1256u);
  EXPECT_EQ(minimal->reads, 8);
  for (int pe = 0; pe < kPes; ++pe) EXPECT_EQ(poly_word(pe, 16), 0xd000010 + by_pe[pe]);
}

TEST_F(PioEngineData, SlowestRunEndsAWrite) {
  build_with_minimal_memory(test_support::test_chip(), 100);
  minimal->extra_latency[0] = sc_core::sc_time(500, sc_core::SC_NS);
  engine->enqueue(write(MonoPlaces::array(0, 2048), 32, kAll), 1000);
  // The first run's data are at the memory at 1120 and taken 600 later; the others' by 1250.
  EXPECT_EQ(signal(), 1720u);
}

TEST_F(PioEngineData, MinimalMemoryGetsAnArrayAsOneTransaction) {
  build_with_minimal_memory(test_support::test_chip(), 100);
  fill_memories(4096);
  enqueue_write(1000, 0);
  // Data from 1114 on, at the memory 1120, taken by 1220; the PE side ends at 1212.
  EXPECT_EQ(signal(), 1220u);
  EXPECT_EQ(minimal->writes, 1);
  for (std::uint64_t pe = 0; pe < kPes; ++pe)
    for (std::uint64_t word = 0; word < 4; ++word)
      EXPECT_EQ(mono_word(32 * pe + 8 * word), 0x5000000 + 8 * word + pe);
}

TEST_F(PioEngineData, BookingAWriteLateDoesNotUndoLaterData) {
  build_with_minimal_memory(test_support::test_chip(), 100);
  fill_memories(4096);
  enqueue_read(1000, 0);
  enqueue_write(1001, 1);
  mono_word(64) = 42;  // by the control unit, before the engine serves the write
  serve_all();
  EXPECT_EQ(minimal->writes, 1);
  EXPECT_EQ(mono_word(64), 42u);
}

TEST_F(PioEngineData, MinimalMemorySmallerThanItsConfigurationIsAFault) {
  build_with_minimal_memory(test_support::test_chip(), 100);
  minimal->bytes.resize(1024);
  try {
    engine->enqueue(read(MonoPlaces::array(1024, 32), 32, kAll), 0);
    FAIL() << "accepted";
  } catch (const cn::MachineFault& fault) {
    EXPECT_STREQ(
        fault.what(),
        "debug access of the PIO engine: mono memory moved 0 of 32 bytes at 1024, though it is configured "
        "with 1048576");
  }
}

class PioEngineMixture : public PioEngineData, public testing::WithParamInterface<bool> {};

/// A mixture of gathers, scatters and arrays under changing masks; the result must be what cn::move_data does
/// alone.
TEST_P(PioEngineMixture, IsThatOfMoveData) {
  constexpr std::uint64_t kBytes = 1 << 14;
  auto config = test_support::test_chip();
  config.pio.arbitration = PioArbitration::reads_overtake_writes;
  if (GetParam()) {
    build_with_minimal_memory(config, 100);
  } else {
    build(config);
  }
  fill_memories(kBytes);
  cn::PolyMemory expected_poly = *poly;
  std::vector<std::uint8_t> expected_mono(mono(), mono() + kBytes);

  std::uint64_t random = 1;
  const auto below = [&](std::uint64_t limit) {
    random = random * 6364136223846793005u + 1442695040888963407u;  // Knuth's MMIX
    return (random >> 33) % limit;
  };
  Cycles now = 0;
  for (int i = 0; i < 200; ++i) {
    cn::Transfer transfer;
    transfer.direction = below(2) ? cn::Direction::mono_to_poly : cn::Direction::poly_to_mono;
    transfer.poly = {int(8 * below(64)), int(8 * (1 + below(12)))};
    transfer.done = {0};
    cn::MonoAddress by_pe[kPes];
    for (auto& address : by_pe) address = 8 * below(kBytes / 8 - 12);
    transfer.mono = below(2) ? MonoPlaces::each(by_pe)
                             : MonoPlaces::array(8 * below(200), std::uint64_t(transfer.poly.size_bytes));
    for (int pe = 0; pe < kPes; ++pe) transfer.enabled.set(pe, below(4) != 0);
    cn::move_data(transfer, expected_poly, expected_mono.data());
    now = engine->enqueue(transfer, now + below(300));
  }
  serve_all();
  EXPECT_EQ(std::memcmp(mono(), expected_mono.data(), kBytes), 0);
  EXPECT_EQ(std::memcmp(poly->words(), expected_poly.words(), std::size_t(kPes) * 1024), 0);
  EXPECT_EQ(semaphores.signals[0].size(), 200u);
}

INSTANTIATE_TEST_SUITE_P(Memories, PioEngineMixture, testing::Bool());

}  // namespace pio_engine_data_test
