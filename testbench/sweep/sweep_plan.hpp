#pragma once

#include <deque>
#include <map>
#include <string>
#include <vector>

#include "testbench/sweep/sweep_points.hpp"

namespace testbench {

/// Which point comes next. Points that share a stream of calls go to one server one after the other, as long
/// as there is other work for the rest: each server records a stream once and keeps the one it used last.
class SweepPlan {
 public:
  struct Order {
    std::size_t point = 0;
    bool replays = false;  ///< a recording pays for itself
  };

  /// @param left numbers of the points that are to be run
  SweepPlan(const Sweep& sweep, const std::vector<std::size_t>& left, bool in_full);

  /// Nothing when all are handed out.
  std::optional<Order> next(int server);

 private:
  struct Stream {
    std::deque<std::size_t> left;
    bool replays = false;
    int servers = 0;  ///< that used it last
  };

  std::vector<Stream>::iterator choose(int server);

  std::vector<Stream> streams_;
  std::map<int, std::size_t> stream_of_server_;
};

}  // namespace testbench
