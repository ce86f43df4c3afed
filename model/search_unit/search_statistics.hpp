#pragma once

#include <cstdint>

namespace model {

/// What a search unit counted, over all of its units.
struct SearchStatistics {
  std::uint64_t queries = 0;
  std::uint64_t nodes = 0;         ///< steps through nodes
  std::uint64_t leaves = 0;        ///< steps through leaves
  std::uint64_t node_tests = 0;    ///< boxes in these nodes
  std::uint64_t leaf_tests = 0;    ///< triangles in these leaves
  std::uint64_t cache_hits = 0;    ///< lines
  std::uint64_t cache_joins = 0;   ///< lines that another query had asked for and that were on the way
  std::uint64_t cache_misses = 0;  ///< lines fetched from mono memory
  std::uint64_t bytes_fetched = 0;
  std::uint64_t bytes_written = 0;       ///< into the buffer
  std::uint64_t bytes_read = 0;          ///< from the buffer
  std::uint64_t busy_cycles = 0;         ///< of a unit with queries in flight
  std::uint64_t stalled_cycles = 0;      ///< of these, all queries of the unit waited for memory
  std::uint64_t node_cycles = 0;         ///< in which a unit began tests of nodes
  std::uint64_t leaf_cycles = 0;         ///< in which a unit began tests of leaves
  std::uint64_t answer_wait_cycles = 0;  ///< time that reads waited for answers, summed over reads
};

}  // namespace model
