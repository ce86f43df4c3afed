#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "firmware/cn/chip/search_unit.hpp"
#include "model/config/chip_config.hpp"
#include "model/observe/search_observer.hpp"
#include "model/search_unit/search_cache.hpp"
#include "model/search_unit/search_statistics.hpp"
#include "model/time/cycles.hpp"

namespace model {

/// The timing of a search unit. Queries wait in one queue; each of the units takes as many as it has places
/// in flight. A query goes from step to step:
///
/// - Its lines are looked up in the unit's cache, one a cycle for all queries of the unit. Missing lines are
///   fetched; meanwhile other queries go on.
/// - When all lines are there, the tests begin in the unit's pipeline for nodes (`width` boxes a cycle) or in
///   that for leaves (a test every leaf_interval_cycles). The step ends with the last test's result.
///
/// Events are worked off in the order of time, among equals in that of their making. Whoever owns this
/// decides when: at once up to the cycle that others have come to, or in SystemC time.
class SearchTiming {
 public:
  struct Owner {
    /// A line leaves for memory; arrived() tells when it is back.
    std::function<void(int unit, cn::MonoAddress first, Cycles at)> fetch;
    std::function<void(int search, Cycles at)> answered;
  };

  SearchTiming(const ChipConfig::SearchUnit& config, Owner owner);

  /// A query is in the buffer from `at` on. @param search a number that answered() tells
  void start(int search, const std::vector<cn::SearchStep>& steps, Cycles at);
  void arrived(int unit, cn::MonoAddress first, Cycles at);
  /// The unit gets another function: its caches are empty.
  void forget_lines();

  /// The cycle of the next event; std::nullopt when there is none, or none before a line arrives.
  std::optional<Cycles> next() const {
    return events_.empty() ? std::nullopt : std::optional<Cycles>(events_.front().at);
  }
  /// Works off the next event.
  void step();

  const SearchStatistics& statistics() const { return statistics_; }
  void set_observer(SearchObserver* observer) { observer_ = observer; }

 private:
  enum class What : std::uint8_t { query, line, go_on, test };
  struct Event {
    Cycles at;
    std::uint64_t number;
    What what;
    int place;           ///< a query in flight; of a line its unit; of a new query its number in `coming_`
    std::uint64_t line;  ///< of a line
  };
  struct Query {
    int search = 0;
    std::vector<cn::SearchStep> steps;
  };
  struct InFlight {
    Query query;
    std::size_t step = 0;
    int lines_missing = 0;
  };
  struct Unit {
    explicit Unit(const ChipConfig::SearchUnit& config)
        : cache(config.cache_bytes, config.cache_line_bytes, config.cache_ways) {}
    SearchCache cache;
    Cycles cache_free = 0;
    Cycles nodes_free = 0;
    Cycles leaves_free = 0;
    std::vector<int> free_places;
    int in_flight = 0;
    int waiting = 0;           ///< of these, for lines
    Cycles accounted_for = 0;  ///< busy and stalled cycles are counted so far
    struct Waiting {
      std::uint64_t line;
      int place;
    };
    std::vector<Waiting> waiting_for;
  };

  static bool later(const Event& a, const Event& b) {
    return a.at != b.at ? a.at > b.at : a.number > b.number;
  }
  void schedule(Cycles at, What what, int place, std::uint64_t line = 0);
  Unit& unit_of(int place) { return units_[std::size_t(place / config_.queries_in_flight)]; }
  void work_off(const Event& event);
  void report();
  void take_queries(Cycles now);
  void go_on(int place, Cycles now);
  void look_up(int place, const cn::SearchStep& step, Cycles now);
  void take_line(int number, std::uint64_t line, Cycles now);
  void test(int place, Cycles now);
  void finish(int place, Cycles now);
  void account(Unit& unit, Cycles now);
  Cycles cycles(int of_unit) const { return Cycles(of_unit) * Cycles(config_.clock_divider); }

  ChipConfig::SearchUnit config_;
  Owner owner_;
  std::vector<Unit> units_;
  std::vector<InFlight> in_flight_;  ///< unit by unit
  std::vector<Query> coming_;        ///< queries that are not in the queue yet
  std::vector<int> free_coming_;
  std::deque<Query> queue_;
  std::vector<Event> events_;  ///< a heap
  std::uint64_t events_made_ = 0;
  Cycles now_ = 0;
  SearchObserver* observer_ = nullptr;
  std::pair<int, int> reported_{0, 0};  ///< queries in flight, and waiting
  SearchStatistics statistics_;
};

}  // namespace model
