// Bridges between chips: exact delays of the bridge, and what a chip's firmware sees of its neighbour's DDR.

#include "model/network/bridge.hpp"

#include <numeric>

#include "model/csx600.hpp"
#include "tests/support/systemc_fixture.hpp"
#include "tests/support/test_chip.hpp"
#include "tests/support/tlm_testers.hpp"

namespace bridge_test {

using model::Cycles;
using model::TimingStyle;
using sc_core::SC_NS;
using sc_core::sc_time;

constexpr cn::MonoAddress kNeighbour = std::uint64_t{1} << 32;

TEST(BridgeTiming, TransactionsFollowEachOtherAtItsWidthAndClock) {
  // 8 bytes a cycle at half the chip's clock: 64 bytes take 16 cycles of the chip; latency 2 x 20.
  model::BridgeTiming bridge({2, 8, 0.5e9, 20}, 1e9);
  const auto first = bridge.forward(64, 100);
  EXPECT_EQ(first.first, 140u);
  EXPECT_EQ(first.last, 156u);
  EXPECT_EQ(first.free, 116u);
  EXPECT_EQ(bridge.forward(0, 100).first, 156u) << "a request waits for the data before it";
  EXPECT_EQ(bridge.backward(64, 100).last, 140u) << "the other way is free";
  EXPECT_EQ(bridge.statistics().bytes, 128u);
  EXPECT_EQ(bridge.statistics().transactions, 3u);
  EXPECT_EQ(bridge.statistics().waiting_cycles, 16u);
}

class Bridge : public test_support::SystemCFixture, public testing::WithParamInterface<TimingStyle> {};

TEST_F(Bridge, ReadPaysBothWaysAndAWriteOne) {
  const model::ChipConfig config =
      test_support::test_chip();  // 1 ns a cycle; bridge 8 bytes a cycle, 20 cycles
  test_support::TestInitiator initiator("initiator");
  model::Bridge bridge("bridge", config);
  test_support::MinimalMemory memory("memory", 4096, sc_time(50, SC_NS));
  initiator.socket.bind(bridge.near_socket);
  bridge.far_socket.bind(memory.socket);
  elaborate();
  std::array<unsigned char, 64> data{};
  // Across at 120, answered at 170; the data cross 162..170, there at 190.
  EXPECT_EQ(initiator.send(tlm::TLM_READ_COMMAND, 0, data.data(), 64, sc_time(100, SC_NS)),
            sc_time(190, SC_NS));
  EXPECT_EQ(initiator.send(tlm::TLM_WRITE_COMMAND, 0, data.data(), 64, sc_time(200, SC_NS)),
            sc_time(270, SC_NS));
  EXPECT_EQ(initiator.send(tlm::TLM_READ_COMMAND, 4096, data.data(), 64, sc_time(300, SC_NS)),
            sc_time(370, SC_NS));
  EXPECT_TRUE(initiator.transaction.is_response_error());
}

/// The test chip with a PIO engine that is never what takes longest.
model::ChipConfig chip() {
  model::ChipConfig config = test_support::test_chip();
  config.pio.setup_cycles = 0;
  config.pio.per_pe_cycles = 0;
  config.pio.bytes_per_cycle = 4096;
  return config;
}

/// Reads 64 bytes a PE of its own DDR, then of its neighbour's, and writes them back there.
struct Outcome {
  Cycles own;
  Cycles neighbour;
  Cycles both_ways;
};

Outcome reach_neighbour(TimingStyle timing, const model::ChipConfig& config) {
  model::Csx600 near("near", config, timing);
  model::Csx600 far("far", config, timing);
  const auto bridge = model::join_by_bridge(near, far, kNeighbour);
  std::vector<std::uint64_t> words(64);
  std::iota(words.begin(), words.end(), 1u);
  std::memcpy(far.mono_ddr->memory().data(), words.data(), 512);
  Outcome outcome{};
  near.control_unit.load([&](cn::Machine& machine) {
    const cn::PolySpan piece = machine.poly_memory().allocate("piece", 64);
    const cn::Semaphore done = machine.allocate_semaphore("done");
    const cn::LaneMask all = cn::LaneMask::first(machine.num_pes());
    Cycles last = near.control_unit.now();
    const auto lap = [&] {
      machine.sem_wait(done);
      return near.control_unit.now() - std::exchange(last, near.control_unit.now());
    };
    machine.async_copy_m2p(done, piece, cn::MonoPlaces::array(0, 64), all);
    outcome.own = lap();
    machine.async_copy_m2p(done, piece, cn::MonoPlaces::array(kNeighbour, 64), all);
    outcome.neighbour = lap();
    EXPECT_EQ(machine.poly_memory().word(7, piece.offset_bytes), 57u);
    machine.async_copy_p2m(done, cn::MonoPlaces::array(kNeighbour + 4096, 64), piece, all);
    outcome.both_ways = lap();
    EXPECT_EQ(*machine.read_mono(cn::MonoPointer<std::uint64_t>{kNeighbour + 8}), 2u);
  });
  near.control_unit.start();
  sc_core::sc_start(sc_time(1, sc_core::SC_SEC), sc_core::SC_EXIT_ON_STARVATION);
  near.control_unit.require_finished();
  EXPECT_EQ(std::memcmp(far.mono_ddr->memory().data() + 4096, words.data(), 512), 0);
  EXPECT_GE(bridge->statistics().bytes, 1024u + 32u);
  EXPECT_EQ(near.ddr_statistics().bytes_read, 512u);
  EXPECT_GE(far.ddr_statistics().bytes_read, 512u);
  EXPECT_EQ(far.ddr_statistics().bytes_written, 512u);
  return outcome;
}

TEST_P(Bridge, FirmwareReachesTheNeighboursMemoryLater) {
  const Outcome fast = reach_neighbour(GetParam(), chip());
  // Twice 20 cycles of the bridge, and twice the way through the far network, 6 cycles.
  EXPECT_EQ(fast.neighbour, fast.own + 52);
}

TEST_P(Bridge, LatencyAndWidthEachCount) {
  const Outcome base = reach_neighbour(GetParam(), chip());
  model::ChipConfig late = chip();
  late.board.bridge_latency_cycles = 120;
  new_context();
  EXPECT_EQ(reach_neighbour(GetParam(), late).neighbour, base.neighbour + 200);
  model::ChipConfig narrow = chip();
  narrow.board.bridge_bytes_per_cycle = 1;
  new_context();
  const Outcome slow = reach_neighbour(GetParam(), narrow);
  EXPECT_EQ(slow.own, base.own);
  EXPECT_GE(slow.neighbour, 512u);
  model::ChipConfig slow_clock = chip();
  slow_clock.board.bridge_clock_hz = 0.25e9;
  new_context();
  EXPECT_GT(reach_neighbour(GetParam(), slow_clock).neighbour, base.neighbour + 100);
}

TEST_F(Bridge, OnlyOneMemoryLiesAtAnAddress) {
  model::Csx600 near("near", test_support::test_chip());
  model::Csx600 far("far", test_support::test_chip());
  EXPECT_THROW(model::join_by_bridge(near, far, 4096), model::AddressMapError);
}

INSTANTIATE_TEST_SUITE_P(Styles, Bridge,
                         testing::Values(TimingStyle::loosely_timed, TimingStyle::approximately_timed),
                         [](const testing::TestParamInfo<TimingStyle>& style) {
                           return style.param == TimingStyle::loosely_timed ? "Lt" : "At";
                         });

}  // namespace bridge_test
