#include "firmware/path_tracer/traversals/treelet_queues.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

namespace treelet_queues_test {

using path_tracer::ProgramConfig;
using path_tracer::TreeletQueues;

constexpr int kPes = 8;
constexpr int kTreelets = 20;

ProgramConfig queue_config() {
  ProgramConfig config;
  config.traversal = path_tracer::Traversal::shared_treelets;
  config.bin_blocks = 4;
  config.tree.resident_nodes = 1;
  config.tree.treelet_nodes = 1;
  return config;
}

class TreeletQueuesTest : public testing::Test {
 protected:
  ProgramConfig config = queue_config();
  path_tracer::Layout layout = make_layout({100, 1, 1 + kTreelets}, kPes, config);
  TreeletQueues queues{layout, config, kPes};
  std::uint64_t record_bytes = std::uint64_t(config.tree.record_bytes());
};

TEST_F(TreeletQueuesTest, RaysOfATreeletFillABlock) {
  queues.expect(kPes);
  EXPECT_FALSE(queues.take_full());
  const auto first = queues.append(3, 5, 1);
  EXPECT_EQ(first.room, 5);
  EXPECT_FALSE(queues.take_full());
  const auto second = queues.append(3, 3, 2);
  EXPECT_EQ(second.room, 3);
  EXPECT_EQ(second.address, first.address + 5 * record_bytes) << "behind the others";
  const auto full = queues.take_full();
  ASSERT_TRUE(full);
  EXPECT_EQ(queues.block(*full).treelet, 3);
  EXPECT_EQ(queues.block(*full).rays, kPes);
  EXPECT_EQ(queues.block(*full).last_writer, 2u);
  EXPECT_EQ(queues.address_of(*full), first.address);
  EXPECT_FALSE(queues.take_full());
  EXPECT_FALSE(queues.take_fullest()) << "it was taken";
}

TEST_F(TreeletQueuesTest, RaysOfDifferentTreeletsLieInDifferentBlocks) {
  queues.expect(2 * kPes);
  const auto a = queues.append(1, 4, 1);
  const auto b = queues.append(2, 4, 1);
  EXPECT_GE(std::max(a.address, b.address) - std::min(a.address, b.address), kPes * record_bytes);
  EXPECT_FALSE(queues.take_full());
}

TEST_F(TreeletQueuesTest, WhatDoesNotFitBeginsTheNextBlock) {
  queues.expect(2 * kPes);
  queues.append(1, 6, 1);
  const auto room = queues.append(1, 5, 2);
  EXPECT_EQ(room.room, 2);
  const auto full = queues.take_full();
  ASSERT_TRUE(full);
  EXPECT_EQ(queues.address_of(*full, 6), room.address);
  const auto rest = queues.take_fullest();
  ASSERT_TRUE(rest);
  EXPECT_EQ(queues.block(*rest).rays, 3);
  EXPECT_EQ(queues.address_of(*rest), room.next_address);
}

TEST_F(TreeletQueuesTest, TakesTheFullestAndOfSeveralTheFirstTreelet) {
  queues.expect(20);
  queues.append(7, 2, 1);
  queues.append(5, 4, 1);
  queues.append(2, 4, 1);
  queues.append(TreeletQueues::kMixed, 3, 1);
  for (const std::int32_t treelet : {2, 5, TreeletQueues::kMixed, 7}) {
    const auto taken = queues.take_fullest();
    ASSERT_TRUE(taken);
    EXPECT_EQ(queues.block(*taken).treelet, treelet);
    queues.release(*taken);
  }
  EXPECT_FALSE(queues.take_fullest());
}

TEST_F(TreeletQueuesTest, FullBlocksAreTakenInTheOrderInWhichTheyFilled) {
  queues.expect(3 * kPes);
  queues.append(9, 1, 1);
  queues.append(4, kPes, 2);
  queues.append(9, kPes - 1, 3);
  EXPECT_EQ(queues.block(queues.take_full().value()).treelet, 4);
  EXPECT_EQ(queues.block(queues.take_full().value()).treelet, 9);
}

/// Treelets get blocks until only as many are left as all expected rays may need; the mixed queue continues.
TEST_F(TreeletQueuesTest, KeepBlocksBackForTheMixedQueue) {
  const int rays = kPes * config.bin_blocks;
  queues.expect(rays);
  int treelets = 0;
  int left = rays;
  while (treelets < kTreelets && left > 0 && queues.has_room(treelets, 1)) {
    queues.append(treelets++, 1, 1);
    --left;
  }
  EXPECT_GT(treelets, 1);
  std::set<int> taken;
  while (left > 0) {
    const int some = std::min(left, 3);
    queues.append(TreeletQueues::kMixed, some, 2);
    left -= some;
    const auto full = queues.take_full();
    EXPECT_TRUE(!full || taken.insert(*full).second);
  }
}

/// Takes turns as the stage does, at random: no two rays share a place, none is lost, the pool is never
/// exhausted.
TEST_F(TreeletQueuesTest, LoseNoRayWhateverRaysAskFor) {
  std::mt19937_64 random(7);
  for (int pass = 0; pass < 50; ++pass) {
    const int rays = 1 + int(random() % std::uint64_t(kPes * config.bin_blocks));
    queues.expect(rays);
    int waiting = rays;  // in no block yet
    int in_blocks = 0;
    int over = 0;
    for (std::uint64_t step = 1; over < rays; ++step) {
      ASSERT_LT(step, 100000u);
      auto taken = queues.take_full();
      if (!taken && waiting == 0) taken = queues.take_fullest();
      int block_rays = std::min(waiting, kPes);
      if (taken) {
        block_rays = queues.block(*taken).rays;
        queues.release(*taken);
        in_blocks -= block_rays;
      } else {
        waiting -= block_rays;
      }
      int still = 0;
      for (int i = 0; i < block_rays; ++i) still += random() % 4 != 0;
      queues.forget(block_rays - still);
      over += block_rays - still;
      std::set<std::uint64_t> places;
      while (still > 0) {
        const int some = 1 + int(random() % std::uint64_t(still));
        auto treelet = std::int32_t(random() % kTreelets);
        if (!queues.has_room(treelet, some)) treelet = TreeletQueues::kMixed;
        const auto room = queues.append(treelet, some, step);
        for (int i = 0; i < some; ++i) {
          const std::uint64_t address = i < room.room
                                            ? room.address + std::uint64_t(i) * record_bytes
                                            : room.next_address + std::uint64_t(i - room.room) * record_bytes;
          ASSERT_TRUE(places.insert(address).second);
          ASSERT_GE(address, layout.treelet_pool.address);
          ASSERT_LT(address, layout.treelet_pool.address +
                                 std::uint64_t(layout.treelet_pool_blocks) * kPes * record_bytes);
        }
        still -= some;
        in_blocks += some;
      }
    }
    ASSERT_EQ(in_blocks, 0);
    ASSERT_FALSE(queues.take_full());
    ASSERT_FALSE(queues.take_fullest());
  }
}

}  // namespace treelet_queues_test
