#include "firmware/path_tracer/stages/transfer_ring.hpp"

#include <gtest/gtest.h>

#include <utility>

#include "tests/support/late_machine.hpp"

namespace transfer_ring_test {

using cn::LaneMask;
using cn::MonoPlaces;
using cn::PolySpan;
using path_tracer::TransferRing;
using Calls = std::vector<std::string>;

class TransferRingTest : public testing::Test {
 protected:
  static constexpr int kBuffers = 3;

  /// Starts one transfer into the step's buffer, of the record at mono address 64 * step.
  void load(std::uint64_t step, int block) {
    ring.copy_m2p(step, block, ring.buffer(step), MonoPlaces::array(64 * step, 0), LaneMask::first(8));
  }
  void save(std::uint64_t step, int block) {
    ring.copy_p2m(step, block, MonoPlaces::array(64 * step, 8), ring.buffer(step), LaneMask::first(8));
  }
  Calls take_calls() { return std::exchange(machine.calls, {}); }

  test_support::LateMachine machine{8, 1024, 4096};
  TransferRing ring{machine, "load", {kBuffers, 16, false}};
};

TEST_F(TransferRingTest, BuffersAreNamedAndTakenInTurn) {
  const auto& buffers = machine.poly_memory().buffers();
  ASSERT_EQ(buffers.size(), 3u);
  EXPECT_EQ(buffers[0].name, "load 0");
  EXPECT_EQ(buffers[2].name, "load 2");
  for (std::uint64_t step = 0; step < 10; ++step) {
    EXPECT_EQ(ring.buffer(step).offset_bytes, buffers[step % 3].span.offset_bytes);
    EXPECT_EQ(ring.buffer(step).size_bytes, 16);
  }
  EXPECT_EQ(machine.semaphore_name({2}), "load 2");
}

TEST_F(TransferRingTest, EachBufferSignalsItsOwnSemaphore) {
  load(0, 0), load(1, 1), save(2, 2), load(0, 0), load(5, 0);
  EXPECT_EQ(take_calls(), (Calls{"m2p load 0", "m2p load 1", "p2m load 2", "m2p load 0", "m2p load 2"}));
}

TEST_F(TransferRingTest, WaitsForAllTransfersOfTheBufferAndNoOther) {
  load(0, 0), load(1, 1), load(0, 0);
  take_calls();
  ring.wait(0);
  EXPECT_EQ(take_calls(), (Calls{"wait load 0", "wait load 0"}));
  EXPECT_EQ(machine.under_way(), 1u);
  ring.wait(0);
  EXPECT_EQ(take_calls(), Calls{}) << "nothing is left to wait for";
  ring.wait(4);  // the same buffer as step 1, whichever step started the transfer
  EXPECT_EQ(take_calls(), (Calls{"wait load 1"}));
  EXPECT_EQ(machine.under_way(), 0u);
}

TEST_F(TransferRingTest, DataHaveArrivedAfterTheWait) {
  for (int i = 0; i < 4096; ++i) machine.mono()[i] = static_cast<std::uint8_t>(i / 64);
  load(7, 0);
  const auto word = [&] { return machine.poly_memory().word(3, ring.buffer(7).offset_bytes); };
  EXPECT_NE(word(), 0x0707070707070707u);
  ring.wait(7);
  EXPECT_EQ(word(), 0x0707070707070707u);
}

TEST_F(TransferRingTest, WaitsForABlock) {
  save(0, 4), save(1, 5), save(2, 4), save(2, 4);
  take_calls();
  ring.wait_block(3);
  EXPECT_EQ(take_calls(), Calls{});
  ring.wait_block(4);
  EXPECT_EQ(take_calls(), (Calls{"wait load 0", "wait load 2", "wait load 2"}));
  ring.wait_block(4);
  EXPECT_EQ(take_calls(), Calls{});
  ring.wait_block(5);
  EXPECT_EQ(take_calls(), (Calls{"wait load 1"}));
}

TEST_F(TransferRingTest, ABufferBelongsToTheBlockThatUsedItLast) {
  save(0, 4);
  ring.wait(0);
  save(3, 6);
  take_calls();
  ring.wait_block(4);
  EXPECT_EQ(take_calls(), Calls{});
  ring.wait_block(6);
  EXPECT_EQ(take_calls(), (Calls{"wait load 0"}));
}

TEST_F(TransferRingTest, WaitsUpToAStep) {
  save(3, 0), save(4, 1), save(5, 2);
  take_calls();
  ring.wait_until(2);
  EXPECT_EQ(take_calls(), Calls{});
  ring.wait_until(4);
  EXPECT_EQ(take_calls(), (Calls{"wait load 0", "wait load 1"}));
  ring.wait_until(100);
  EXPECT_EQ(take_calls(), (Calls{"wait load 2"}));
}

TEST_F(TransferRingTest, BookkeepingCostsTheControlUnit) {
  const auto cost = [&](auto act) {
    const std::uint64_t before = machine.mono_instructions;
    act();
    return machine.mono_instructions - before;
  };
  EXPECT_EQ(cost([&] { load(0, 0); }), 12u);
  EXPECT_EQ(cost([&] { save(1, 0); }), 12u);
  EXPECT_EQ(cost([&] { ring.wait(2); }), 3u);
  EXPECT_EQ(cost([&] { ring.wait_until(0); }), 3u * kBuffers + 3u);
  EXPECT_EQ(cost([&] { ring.wait_block(9); }), 3u * kBuffers);
}

/// The order of calls of the firmware's pipeline: loads up to n steps ahead, a wait before each step, saves
/// that stay under way for n steps. A step finds in its buffer what was loaded for it, and no more steps than
/// buffers are under way.
TEST_F(TransferRingTest, PipelineKeepsAsManyStepsUnderWayAsThereAreBuffers) {
  for (int i = 0; i < 4096; ++i) machine.mono()[i] = static_cast<std::uint8_t>(i / 64);
  constexpr std::uint64_t kSteps = 20;
  std::uint64_t loads_issued = 0;
  std::size_t most_under_way = 0;
  for (std::uint64_t step = 0; step < kSteps; ++step) {
    for (; loads_issued < std::min(kSteps, step + kBuffers); ++loads_issued) load(loads_issued, 0);
    most_under_way = std::max(most_under_way, machine.under_way());
    ring.wait(step);
    EXPECT_EQ(machine.poly_memory().word(5, ring.buffer(step).offset_bytes), step * 0x0101010101010101u);
  }
  EXPECT_EQ(most_under_way, std::size_t(kBuffers));
  EXPECT_EQ(machine.under_way(), 0u);
}

class SynchronousRing : public TransferRingTest {
 protected:
  static constexpr std::uint64_t kStep = 7;

  void load_at_once() {
    synchronous.copy_m2p(kStep, 2, synchronous.buffer(kStep), MonoPlaces::array(64 * kStep, 0),
                         LaneMask::first(8));
  }
  void save_at_once() {
    synchronous.copy_p2m(kStep, 2, MonoPlaces::array(64 * kStep, 16), synchronous.buffer(kStep),
                         LaneMask::first(8));
  }
  std::uint64_t& word() { return machine.poly_memory().word(3, synchronous.buffer(kStep).offset_bytes); }

  TransferRing synchronous{machine, "direct", {1, 16, true}};
};

TEST_F(SynchronousRing, EachCopyIsOverBeforeTheNextInstruction) {
  for (int i = 0; i < 4096; ++i) machine.mono()[i] = static_cast<std::uint8_t>(i / 64);
  load_at_once();
  EXPECT_EQ(take_calls(), (Calls{"m2p direct 0", "wait direct 0"}));
  EXPECT_EQ(machine.under_way(), 0u);
  EXPECT_EQ(word(), 0x0707070707070707u);

  word() = 0x1122334455667788u;
  save_at_once();
  save_at_once();
  EXPECT_EQ(take_calls(), (Calls{"p2m direct 0", "wait direct 0", "p2m direct 0", "wait direct 0"}));
  EXPECT_EQ(machine.under_way(), 0u);
  EXPECT_EQ(machine.mono()[64 * kStep + 3 * 16], 0x88);
}

TEST_F(SynchronousRing, LeavesNothingToWaitFor) {
  load_at_once();
  save_at_once();
  take_calls();
  synchronous.wait(kStep);
  synchronous.wait_block(2);
  synchronous.wait_until(100);
  EXPECT_EQ(take_calls(), Calls{});
}

TEST_F(SynchronousRing, WaitsForItsOwnCopyOnly) {
  load(0, 0);
  load_at_once();
  EXPECT_EQ(machine.under_way(), 1u) << "of the ring with buffers";
  EXPECT_EQ(take_calls(), (Calls{"m2p load 0", "m2p direct 0", "wait direct 0"}));
}

TEST_F(SynchronousRing, PaysForTheRequestAndTheWait) {
  load_at_once();
  EXPECT_EQ(machine.mono_instructions, 12u + 3u);
}

TEST_F(TransferRingTest, RunsOutOfPolySramOrSemaphoresByName) {
  try {
    TransferRing large(machine, "save", {2, 700, false});
    FAIL();
  } catch (const cn::PolyMemoryOverflow& overflow) {
    EXPECT_NE(std::string(overflow.what()).find("'save 1'"), std::string::npos) << overflow.what();
  }
  try {
    TransferRing many(machine, "spare", {100, 0, false});
    FAIL();
  } catch (const cn::MachineFault& fault) {
    EXPECT_NE(std::string(fault.what()).find("'spare 60'"), std::string::npos) << fault.what();
  }
}

}  // namespace transfer_ring_test
