#pragma once

#include <systemc>

#include "model/time/cycles.hpp"

namespace model {

/// Traffic of a unit that works beside the firmware, as others on the chip see it, loosely timed: the host
/// link's packets, the search unit's lines. It is booked on the network and the memory piece by piece and no
/// earlier than others come that far, so that a long transfer does not push aside what comes before its end.
class BookedTraffic : public virtual sc_core::sc_interface {
 public:
  /// Books what is due up to `cycle`. To be called before anything later is booked and before SystemC time
  /// reaches `cycle`; what is overdue has passed unobserved and is left out.
  virtual void book_until(Cycles cycle) = 0;
  /// Whether packets are on their way at the present SystemC time. Whoever runs ahead of it then could miss a
  /// transfer that follows.
  virtual bool in_progress() const = 0;
};

/// Of any number of units: a network or a control unit also works without any.
using BookedTrafficPort = sc_core::sc_port<BookedTraffic, 0, sc_core::SC_ZERO_OR_MORE_BOUND>;

inline void book_until(BookedTrafficPort& traffic, Cycles cycle) {
  for (int i = 0; i < traffic.size(); ++i) traffic[i]->book_until(cycle);
}
inline bool in_progress(BookedTrafficPort& traffic) {
  for (int i = 0; i < traffic.size(); ++i)
    if (traffic[i]->in_progress()) return true;
  return false;
}

}  // namespace model
