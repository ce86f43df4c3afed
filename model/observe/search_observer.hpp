#pragma once

#include "model/time/cycles.hpp"

namespace model {

/// Told what the search unit does when it is booked, which may be ahead of SystemC time, in the order of
/// time.
class SearchObserver {
 public:
  virtual ~SearchObserver() = default;
  /// So many queries are in flight from now on, and so many of them wait for memory.
  virtual void searching(int in_flight, int waiting, Cycles at) = 0;
};

}  // namespace model
