#include "firmware/path_tracer/traversals/traversal_bin.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <deque>
#include <random>

#include "firmware/path_tracer/stages/ray_queue.hpp"
#include "testbench/machine/native_machine.hpp"

namespace traversal_bin_test {

using path_tracer::make_layout;
using path_tracer::ProgramConfig;
using path_tracer::QueuedRay;
using path_tracer::RayQueue;
using path_tracer::TransferRing;
using path_tracer::TraversalBin;

constexpr int kPes = 8;

ProgramConfig config_with(int bin_blocks, int n) {
  ProgramConfig config;
  config.traversal = path_tracer::Traversal::temporary_bin;
  config.bin_blocks = bin_blocks;
  config.n = n;
  return config;
}

class TraversalBinTest : public testing::Test {
 protected:
  ProgramConfig config = config_with(2, 1);
  path_tracer::Layout layout = make_layout({10, 1, 4}, kPes, config);
  TraversalBin bin{layout, config, kPes};
};

TEST_F(TraversalBinTest, GivesFullBlocksUntilOnlyARestIsLeft) {
  EXPECT_FALSE(bin.take_full());
  EXPECT_FALSE(bin.take_rest());
  bin.append(kPes - 1, 1, 0);
  EXPECT_FALSE(bin.take_full());
  bin.append(2, 2, 0);
  EXPECT_EQ(bin.take_full(), 0);
  EXPECT_EQ(bin.rays(0), kPes);
  EXPECT_FALSE(bin.take_full()) << "one ray is left";
  EXPECT_EQ(bin.take_rest(), 1);
  EXPECT_EQ(bin.rays(1), 1);
  EXPECT_FALSE(bin.take_rest());
}

/// The next block begins behind a rest, wherever the rest ended.
TEST_F(TraversalBinTest, BeginsANewBlockBehindARest) {
  bin.append(3, 1, 0);
  EXPECT_EQ(bin.tail(), 3);
  EXPECT_EQ(bin.take_rest(), 0);
  EXPECT_EQ(bin.tail(), kPes);
  bin.append(kPes, 2, 1);
  EXPECT_EQ(bin.take_full(), 1);
  EXPECT_EQ(bin.rays(1), kPes);
}

TEST_F(TraversalBinTest, CountsThePassOfABlocksFirstRay) {
  bin.append(5, 1, 0);
  bin.append(5, 2, 1);
  bin.append(6, 3, 2);
  EXPECT_EQ(bin.take_full(), 0);
  EXPECT_EQ(bin.pass(0), 1u);
  EXPECT_EQ(bin.take_full(), 1);
  EXPECT_EQ(bin.pass(1), 2u);
  bin.append(1, 4, 0);
  EXPECT_EQ(bin.take_rest(), 2);
  EXPECT_EQ(bin.pass(2), 1u) << "no ray of those before is left";
}

TEST_F(TraversalBinTest, KnowsTheLastStepThatSavedToABlock) {
  bin.append(5, 7, 0);
  EXPECT_EQ(bin.last_writer(0), 7u);
  bin.append(3, 8, 0);  // fills it to the end
  EXPECT_EQ(bin.last_writer(0), 8u);
  EXPECT_EQ(bin.last_writer(1), 0u);
  bin.append(6, 9, 0);
  EXPECT_EQ(bin.last_writer(0), 8u);
  bin.append(6, 10, 0);  // across the border
  EXPECT_EQ(bin.last_writer(1), 10u);
  EXPECT_EQ(bin.last_writer(2), 10u);
  bin.append(0, 11, 0);
  EXPECT_EQ(bin.last_writer(2), 10u);
}

TEST_F(TraversalBinTest, LiesInItsRegionBlockByBlock) {
  const int blocks = path_tracer::traversal_bin_blocks(config);
  EXPECT_EQ(bin.capacity(), blocks * kPes);
  EXPECT_EQ(bin.record_bytes(), config.tree.record_bytes());
  EXPECT_EQ(bin.address(), layout.traversal_bin.address);
  for (const auto& region : layout.regions)
    if (std::strcmp(region.name, "traversal bin") == 0) {
      EXPECT_EQ(region.bytes, std::uint64_t(bin.capacity()) * std::uint64_t(bin.record_bytes()));
    }
  for (int block = 0; block < blocks; ++block)
    EXPECT_EQ(bin.address_of(block), bin.address() + std::uint64_t(block * kPes * bin.record_bytes()));
}

/// Compares with a queue of ray numbers: rays are taken as they were appended, in order. No ray that was not
/// taken is overwritten as long as there are no more rays than slots.
TEST_F(TraversalBinTest, GoesRoundWithoutLosingARay) {
  struct Ray {
    int number;
    std::uint64_t step;
  };
  std::mt19937 random(5);
  std::vector<int> ring(std::size_t(bin.capacity()), -1);
  std::deque<Ray> waiting;
  int next = 0;
  int rounds = 0;
  int in_flight = 0;
  const int most = config.bin_blocks * kPes;
  for (std::uint64_t step = 1; step < 3000; ++step) {
    const int room = most - int(waiting.size()) - in_flight;
    const int count = std::min(room, int(random() % (kPes + 1)));
    for (int i = 0; i < count; ++i) {
      int& place = ring[std::size_t((bin.tail() + i) % bin.capacity())];
      ASSERT_EQ(place, -1) << "still waits";
      place = next;
      waiting.push_back({next++, step});
    }
    bin.append(count, step, step % 3);
    std::optional<int> block = bin.take_full();
    if (!block && random() % 4 == 0) block = bin.take_rest();
    in_flight = 0;
    if (!block) continue;
    in_flight = bin.rays(*block);
    rounds += *block == 0;
    for (int i = 0; i < bin.rays(*block); ++i) {
      int& place = ring[std::size_t(*block * kPes + i)];
      ASSERT_EQ(place, waiting.front().number);
      ASSERT_LE(waiting.front().step, bin.last_writer(*block));
      place = -1;
      waiting.pop_front();
    }
  }
  EXPECT_GT(rounds, 50);
}

/// Runs on a native machine. Rays name their slots and lie packed.
class RayQueueTest : public testing::Test {
 protected:
  RayQueueTest() {
    config.traversal = path_tracer::Traversal::refill;
    layout = make_layout({10, 3, 4}, kPes, config);
    machine.emplace(kPes, 6144, layout.total_bytes);
    saves.emplace(*machine, "save buffer", TransferRing::Buffers{2, RayQueue::room_bytes(config), false});
    queue.emplace(*machine, kernels, layout);
    light_place = {machine->poly_memory().allocate("light places", sizeof(cn::MonoAddress)).offset_bytes};
    for (int pe = 0; pe < kPes; ++pe)
      machine->poly_memory().word(pe, light_place.offset_bytes) =
          (layout.lights + std::uint64_t(pe % 3)).address;
  }

  /// Rays of a block of slots, whose x is 100 * step + PE.
  void enqueue(std::uint64_t step, int block, const cn::LaneMask& with_ray) {
    path_tracer::BufferCutter cutter(saves->buffer(step));
    const path_tracer::RayRoom room = queue->take_room(cutter);
    saves->wait(step);
    for (int pe = 0; pe < kPes; ++pe) {
      const double x = 100.0 * double(step) + pe;
      std::memcpy(&machine->poly_memory().word(pe, room.ray.span().offset_bytes), &x, sizeof(x));
    }
    queue->save(*saves, step, {block}, room, light_place, with_ray);
  }
  QueuedRay queued(int index) { return *machine->read_mono(layout.ray_queue + std::uint64_t(index), 1); }

  ProgramConfig config;
  path_tracer::Layout layout;
  path_tracer::Kernels kernels = path_tracer::kernels(cn::narrowest_level());
  std::optional<testbench::NativeMachine> machine;
  std::optional<TransferRing> saves;
  std::optional<RayQueue> queue;
  path_tracer::PolyField<cn::MonoAddress> light_place;
};

cn::LaneMask lanes(std::initializer_list<int> pes) {
  cn::LaneMask mask;
  for (const int pe : pes) mask.set(pe, true);
  return mask;
}

TEST_F(RayQueueTest, PacksRaysInTheOrderOfTheirPes) {
  enqueue(0, 0, lanes({1, 4, 7}));
  enqueue(1, 2, lanes({0, 2}));
  saves->wait_until(1);
  ASSERT_EQ(queue->rays(), 5);
  const double x[] = {1, 4, 7, 100, 102};
  const int slots[] = {1, 4, 7, 16, 18};
  const int lights[] = {1, 1, 1, 0, 2};
  for (int i = 0; i < 5; ++i) {
    const QueuedRay ray = queued(i);
    EXPECT_EQ(ray.ray.origin.x, x[i]);
    EXPECT_EQ(ray.slot, slots[i]);
    EXPECT_EQ(ray.light, lights[i]);
  }
}

TEST_F(RayQueueTest, HandsOutRaysOnce) {
  enqueue(3, 0, cn::LaneMask::first(kPes));
  EXPECT_EQ(queue->left(), kPes);
  EXPECT_EQ(queue->next_place(), layout.ray_queue.address);
  queue->take(3);
  EXPECT_EQ(queue->left(), kPes - 3);
  EXPECT_EQ(queue->next_place(), (layout.ray_queue + 3).address);
  queue->take(kPes - 3);
  EXPECT_EQ(queue->left(), 0);
  queue->clear();
  EXPECT_EQ(queue->rays(), 0);
  EXPECT_EQ(queue->next_place(), layout.ray_queue.address);
  saves->wait_until(3);
}

TEST_F(RayQueueTest, KnowsTheLastStepThatBroughtRays) {
  enqueue(5, 0, lanes({2}));
  EXPECT_EQ(queue->last_writer(), 5u);
  enqueue(6, 1, cn::LaneMask{});
  EXPECT_EQ(queue->last_writer(), 5u) << "the later step brought none";
  EXPECT_EQ(queue->rays(), 1);
  enqueue(7, 2, lanes({0}));
  EXPECT_EQ(queue->last_writer(), 7u);
  saves->wait_until(7);
}

}  // namespace traversal_bin_test
