// A search unit's pipelines, caches and queue, without SystemC: cycles computed by hand.

#include "model/search_unit/search_timing.hpp"

#include <gtest/gtest.h>

#include <map>
#include <tuple>

namespace search_timing_test {

using cn::SearchStep;
using model::Cycles;
using Kind = cn::SearchStep::Kind;

/// Boxes in pairs, 10 cycles for a node; a triangle every 3 cycles, 20 for a leaf; two queries in flight; a
/// cache of two sets of two lines of 64 bytes, 2 cycles.
model::ChipConfig::SearchUnit test_unit() {
  model::ChipConfig::SearchUnit unit{};
  unit.units = 1;
  unit.width = 2;
  unit.queries_in_flight = 2;
  unit.node_cycles = 10;
  unit.leaf_cycles = 20;
  unit.leaf_interval_cycles = 3;
  unit.clock_divider = 1;
  unit.cache_bytes = 256;
  unit.cache_line_bytes = 64;
  unit.cache_ways = 2;
  unit.cache_hit_cycles = 2;
  return unit;
}

/// A unit whose lines take `latency` cycles.
class Bench {
 public:
  explicit Bench(const model::ChipConfig::SearchUnit& unit, Cycles latency = 40)
      : timing(unit, {[this, latency](int of, cn::MonoAddress first, Cycles at) {
                        fetches.emplace_back(of, first, at);
                        timing.arrived(of, first, at + latency);
                      },
                      [this](int entry, Cycles at) { answered[entry] = at; }}) {}

  void run() {
    while (timing.next()) timing.step();
  }
  /// When a single query is answered that starts at `at`.
  Cycles answer(const std::vector<SearchStep>& steps, Cycles at) {
    timing.start(0, steps, at);
    run();
    return answered[0];
  }

  std::vector<std::tuple<int, cn::MonoAddress, Cycles>> fetches;
  std::map<int, Cycles> answered;
  model::SearchTiming timing;
};

const SearchStep kNode{Kind::node, 4, 0, 64};
const SearchStep kLeaf{Kind::leaf, 2, 64, 100};

TEST(SearchTiming, AQueryPaysForLinesAndTestsStepByStep) {
  Bench bench(test_unit());
  // Line 0 missing at 102, there at 142; two pairs of boxes begin at 142 and 143; 153. Lines 1 and 2 missing
  // at 155 and 156, there at 196; triangles at 196 and 199; 219.
  EXPECT_EQ(bench.answer({kNode, kLeaf}, 100), 219u);
  using Fetch = std::tuple<int, cn::MonoAddress, Cycles>;
  EXPECT_EQ(bench.fetches, (std::vector<Fetch>{{0, 0, 102}, {0, 64, 155}, {0, 128, 156}}));
  const model::SearchStatistics& counted = bench.timing.statistics();
  EXPECT_EQ(counted.queries, 1u);
  EXPECT_EQ(counted.nodes, 1u);
  EXPECT_EQ(counted.leaves, 1u);
  EXPECT_EQ(counted.node_tests, 4u);
  EXPECT_EQ(counted.leaf_tests, 2u);
  EXPECT_EQ(counted.cache_misses, 3u);
  EXPECT_EQ(counted.bytes_fetched, 192u);
  EXPECT_EQ(counted.busy_cycles, 119u);
  EXPECT_EQ(counted.stalled_cycles, 42u + 43u) << "100 to 142 and 153 to 196";
  EXPECT_EQ(counted.node_cycles, 2u);
  EXPECT_EQ(counted.leaf_cycles, 6u);
}

TEST(SearchTiming, LinesInTheCacheAreNotFetchedAgain) {
  Bench bench(test_unit());
  bench.answer({kNode}, 0);
  // Known at 1002; boxes at 1002 and 1003; 1013.
  EXPECT_EQ(bench.answer({kNode}, 1000), 1013u);
  EXPECT_EQ(bench.timing.statistics().cache_hits, 1u);
  EXPECT_EQ(bench.fetches.size(), 1u);
  bench.timing.forget_lines();
  bench.answer({kNode}, 2000);
  EXPECT_EQ(bench.fetches.size(), 2u);
}

TEST(SearchTiming, ASlowerClockStretchesAllButMemory) {
  model::ChipConfig::SearchUnit slow = test_unit();
  slow.clock_divider = 4;
  Bench bench(slow);
  // Known missing at 8, there at 48; boxes at 48 and 52; 92.
  EXPECT_EQ(bench.answer({kNode}, 0), 92u);
}

TEST(SearchTiming, QueriesShareALineOnTheWayAndThePipelines) {
  Bench bench(test_unit());
  bench.timing.start(0, {kNode}, 0);
  bench.timing.start(1, {kNode}, 0);
  bench.run();
  EXPECT_EQ(bench.fetches.size(), 1u);
  EXPECT_EQ(bench.timing.statistics().cache_joins, 1u);
  // The line is there at 42; pairs of boxes at 42, 43 and 44, 45.
  EXPECT_EQ(bench.answered[0], 53u);
  EXPECT_EQ(bench.answered[1], 55u);
}

TEST(SearchTiming, AQueryWaitsForAPlaceInFlight) {
  model::ChipConfig::SearchUnit one_at_a_time = test_unit();
  one_at_a_time.queries_in_flight = 1;
  Bench bench(one_at_a_time);
  bench.timing.start(0, {kNode}, 0);
  bench.timing.start(1, {kNode}, 0);
  bench.run();
  EXPECT_EQ(bench.answered[0], 53u);
  EXPECT_EQ(bench.answered[1], 53u + 2 + 1 + 10) << "begins at 53, finds its line";
}

TEST(SearchTiming, UnitsTakeQueriesInTurnAndHaveCachesOfTheirOwn) {
  model::ChipConfig::SearchUnit two = test_unit();
  two.units = 2;
  Bench bench(two);
  bench.timing.start(0, {kNode}, 0);
  bench.timing.start(1, {kNode}, 0);
  bench.run();
  ASSERT_EQ(bench.fetches.size(), 2u);
  EXPECT_EQ(std::get<0>(bench.fetches[0]), 0);
  EXPECT_EQ(std::get<0>(bench.fetches[1]), 1);
  EXPECT_EQ(bench.answered[0], bench.answered[1]);
  EXPECT_EQ(bench.timing.statistics().busy_cycles, 2 * 53u);
}

TEST(SearchTiming, AQueryWithoutStepsIsAnsweredAtOnce) {
  Bench bench(test_unit());
  EXPECT_EQ(bench.answer({}, 17), 17u);
}

TEST(SearchTiming, SlowMemoryIsHiddenByQueriesInFlight) {
  const auto cycles_of_sixteen = [](int in_flight) {
    model::ChipConfig::SearchUnit unit = test_unit();
    unit.queries_in_flight = in_flight;
    Bench bench(unit, 100);
    for (int i = 0; i < 16; ++i) bench.timing.start(i, {{Kind::node, 2, cn::MonoAddress(i) * 64, 64}}, 0);
    bench.run();
    Cycles last = 0;
    for (const auto& [entry, at] : bench.answered) last = std::max(last, at);
    return last;
  };
  EXPECT_EQ(cycles_of_sixteen(1), 16 * (2 + 100 + 10u));
  EXPECT_EQ(cycles_of_sixteen(16), 15 + 2 + 100 + 10u) << "a line a cycle";
}

TEST(SearchCache, ReplacesTheLineUsedLongestAgo) {
  using Found = model::SearchCache::Found;
  model::SearchCache cache(256, 64, 2);  // two sets: even and odd lines
  for (const std::uint64_t line : {0, 2}) {
    EXPECT_EQ(cache.look_up(line), Found::missing);
    EXPECT_EQ(cache.look_up(line), Found::on_the_way);
    cache.arrived(line);
    EXPECT_EQ(cache.look_up(line), Found::here);
  }
  EXPECT_EQ(cache.look_up(0), Found::here);
  EXPECT_EQ(cache.look_up(4), Found::missing) << "in place of 2";
  EXPECT_EQ(cache.look_up(0), Found::here);
  EXPECT_EQ(cache.look_up(2), Found::missing) << "in place of 0, as 4 is on the way";
  EXPECT_EQ(cache.look_up(6), Found::missing) << "without a place";
  EXPECT_EQ(cache.look_up(6), Found::missing);
  cache.arrived(6);
  EXPECT_EQ(cache.look_up(6), Found::missing);
}

}  // namespace search_timing_test
