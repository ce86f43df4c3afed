// The search unit on the network: queries and answers by programmed I/O, its lines from the DDR, loosely and
// approximately timed.
#include "model/search_unit/search_unit.hpp"

#include "model/csx600.hpp"
#include "tests/network/search_chain.hpp"
#include "tests/support/pio_bench.hpp"

namespace search_unit_test {

using model::Cycles;
using model::TimingStyle;
using sc_core::SC_NS;
using sc_core::sc_time;
using search_chain::ChainSearch;
using test_support::kAll;
using test_support::kPes;
using tlm::TLM_READ_COMMAND;
using tlm::TLM_WRITE_COMMAND;

constexpr std::uint64_t kUnit = std::uint64_t{1} << 41;

/// The test chip with a unit one hop (2 cycles) away: 16 bytes a cycle into its buffer, all boxes at a time
/// in 10 cycles, two queries in flight.
model::ChipConfig chip_with_unit() {
  auto config = test_support::test_chip();
  model::ChipConfig::SearchUnit& unit = config.search_unit;
  unit.units = 1;
  unit.width = 4;
  unit.queries_in_flight = 2;
  unit.node_cycles = 10;
  unit.leaf_cycles = 20;
  unit.leaf_interval_cycles = 1;
  unit.clock_divider = 1;
  unit.cache_bytes = 1024;
  unit.cache_line_bytes = 64;
  unit.cache_ways = 2;
  unit.cache_hit_cycles = 2;
  unit.buffer_bytes = 1024;
  unit.first_address = kUnit;
  unit.bytes_per_cycle = 16;
  unit.hops = 1;
  return config;
}

class SearchUnit : public test_support::PioBench {
 protected:
  void build_with_unit(TimingStyle style = TimingStyle::loosely_timed) {
    build(chip, style);
    unit = std::make_unique<model::SearchUnit>("search_unit", chip, clock, event_queue.get());
    network->bind(unit->socket, "search_unit", {kUnit, 1024}, {16, 1});
    initiator = network->bind_initiator(unit->mono_socket);
    network->booked_traffic.bind(unit->traffic);
    engine->follow(network->map());
    unit->program(search);
    for (std::uint64_t i = 0; i < 64; ++i) {
      const ChainSearch::Node node{(i + 1) * 64, 100 + i, 0};
      std::memcpy(mono() + i * 64, &node, sizeof(node));
    }
  }
  /// Each PE's query, and where its sum is loaded to.
  void fill_queries(std::uint64_t nodes) {
    for (int pe = 0; pe < kPes; ++pe) {
      poly->word(pe, 0) = std::uint64_t(pe) * 128;
      poly->word(pe, 8) = nodes;
    }
  }
  static cn::MonoPlaces queries() { return cn::MonoPlaces::array(kUnit, 16); }
  static cn::MonoPlaces sums() { return cn::MonoPlaces::array(places().answers[0], 8); }
  static cn::SearchPlaces places() { return cn::search_places({kUnit, 1024}, 16, {8, 8}); }

  model::ChipConfig chip = chip_with_unit();
  std::shared_ptr<ChainSearch> search = std::make_shared<ChainSearch>();
  std::unique_ptr<model::SearchUnit> unit;
  model::Initiator initiator{};
};

TEST_F(SearchUnit, AReadOfAnAnswerTakesUntilItIsFound) {
  build_with_unit();
  elaborate();
  ChainSearch::Query query{0, 1};
  // Data at the buffer from 102, one cycle: the query is there at 103. Line missing at 105; its request at
  // the DDR at 111; a page miss, 30 cycles, and 4 of data: 145; the link 4 cycles longer, 6 back.
  control.send(TLM_WRITE_COMMAND, kUnit, &query, 16, sc_time(100, SC_NS));
  std::uint64_t sum = 0;
  const sc_time found = control.send(TLM_READ_COMMAND, places().answers[0], &sum, 8, sc_time(100, SC_NS));
  EXPECT_EQ(sum, 100u);
  const model::SearchStatistics counted = unit->statistics();
  EXPECT_EQ(counted.queries, 1u);
  EXPECT_EQ(counted.cache_misses, 1u);
  EXPECT_EQ(counted.bytes_written, 16u);
  EXPECT_EQ(counted.bytes_read, 8u);
  EXPECT_EQ(network->statistics(initiator).bytes, 64u);
  // A second query finds the line: there at 1003, known at 1005, found at 1015; a cycle at the port, 2 back.
  query.nodes = 1;
  query.first = 0;
  control.send(TLM_WRITE_COMMAND, kUnit + 16, &query, 16, sc_time(1000, SC_NS));
  EXPECT_EQ(control.send(TLM_READ_COMMAND, places().answers[0] + 8, &sum, 8, sc_time(1000, SC_NS)),
            sc_time(1018, SC_NS));
  // An answer that is there costs what a read of a memory costs: request 2, port 1, 2 back.
  EXPECT_EQ(control.send(TLM_READ_COMMAND, places().answers[0] + 8, &sum, 8, sc_time(2000, SC_NS)),
            sc_time(2005, SC_NS));
  EXPECT_EQ(unit->statistics().answer_wait_cycles, counted.answer_wait_cycles + 11)
      << "its request comes at 1004, behind the query on the link";
  EXPECT_GT(found, sc_time(150, SC_NS));
}

TEST_F(SearchUnit, AnotherProgramDoesNotWaitForTheSearchesOfTheOneBefore) {
  build_with_unit();
  elaborate();
  ChainSearch::Query query{0, 16};
  control.send(TLM_WRITE_COMMAND, kUnit, &query, 16, sc_time(100, SC_NS));
  unit->program(search);
  query.nodes = 1;
  control.send(TLM_WRITE_COMMAND, kUnit, &query, 16, sc_time(5000, SC_NS));
  std::uint64_t sum = 0;
  const sc_time found = control.send(TLM_READ_COMMAND, places().answers[0], &sum, 8, sc_time(5000, SC_NS));
  EXPECT_EQ(sum, 100u);
  EXPECT_LT(found, sc_time(5200, SC_NS));
  EXPECT_EQ(unit->statistics().queries, 2u);
}

TEST_F(SearchUnit, DebugAccessesTakeNoTimeAndThereIsNoPointer) {
  build_with_unit();
  elaborate();
  ChainSearch::Query query{64, 2};
  std::uint64_t end = 0;
  EXPECT_EQ(control.debug(TLM_WRITE_COMMAND, kUnit, &query, 16), 16u);
  EXPECT_EQ(control.debug(TLM_READ_COMMAND, places().answers[1], &end, 8), 8u);
  EXPECT_EQ(end, 192u);
  EXPECT_EQ(unit->statistics().queries, 0u);
  EXPECT_FALSE(control.ask_for_pointer(kUnit));
}

class SearchUnitInBothStyles : public SearchUnit, public ::testing::WithParamInterface<TimingStyle> {};

TEST_P(SearchUnitInBothStyles, QueriesOfAllPesAreAnswered) {
  build_with_unit(GetParam());
  fill_queries(3);
  run([&] {
    engine->enqueue(write(queries(), 16, kAll, 0), 0);
    engine->enqueue(read(sums(), 8, kAll, 1), 0);
    serve_all();
  });
  for (int pe = 0; pe < kPes; ++pe)
    EXPECT_EQ(poly_word(pe, 0), 3 * (100 + 2 * std::uint64_t(pe)) + 3) << "PE " << pe;
  const model::SearchStatistics counted = unit->statistics();
  EXPECT_EQ(counted.queries, 8u);
  EXPECT_EQ(counted.nodes, 24u);
  EXPECT_EQ(counted.cache_hits + counted.cache_joins + counted.cache_misses, 24u);
  EXPECT_EQ(counted.bytes_fetched, counted.cache_misses * 64);
  EXPECT_EQ(network->statistics(initiator).bytes, counted.bytes_fetched);
  EXPECT_GT(counted.answer_wait_cycles, 0u);
  EXPECT_GT(counted.stalled_cycles, 0u) << "two queries do not hide the DDR";
  EXPECT_GE(counted.busy_cycles, counted.stalled_cycles);
  EXPECT_EQ(counted.bytes_written, 128u);
  EXPECT_EQ(counted.bytes_read, 64u);
}

INSTANTIATE_TEST_SUITE_P(Styles, SearchUnitInBothStyles,
                         ::testing::Values(TimingStyle::loosely_timed, TimingStyle::approximately_timed),
                         [](const auto& style) {
                           return style.param == TimingStyle::loosely_timed ? "LooselyTimed"
                                                                            : "ApproximatelyTimed";
                         });

TEST_F(SearchUnit, OthersOnTheNetworkComeBehindWhatTheUnitHasBookedBefore) {
  build_with_unit();
  elaborate();
  ChainSearch::Query query{0, 1};
  control.send(TLM_WRITE_COMMAND, kUnit, &query, 16, sc_time(100, SC_NS));
  std::uint64_t word = 0;
  // The unit's line leaves at 105, before the host of a page that it opens comes at 106: a page hit behind
  // it.
  const sc_time behind = host.send(TLM_READ_COMMAND, 8, &word, 8, sc_time(106, SC_NS));
  EXPECT_EQ(unit->statistics().cache_misses, 0u) << "the host asks nobody";
  const sc_time control_behind = control.send(TLM_READ_COMMAND, 16, &word, 8, sc_time(500, SC_NS));
  EXPECT_EQ(unit->statistics().cache_misses, 1u) << "booked before the control unit's read";
  EXPECT_GT(control_behind, behind);
}

}  // namespace search_unit_test
