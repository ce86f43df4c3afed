#pragma once

#include <systemc>

#include "model/time/cycles.hpp"

namespace model {

/// The host link's packets as others on the chip see them, loosely timed. They are booked on the network and
/// the memory one by one and no earlier than others come that far, so that a long transfer does not push
/// aside what comes before its end.
class HostTraffic : public virtual sc_core::sc_interface {
 public:
  /// Books what is due up to `cycle`. To be called before anything later is booked and before SystemC time
  /// reaches `cycle`; what is overdue has passed unobserved and is left out.
  virtual void book_until(Cycles cycle) = 0;
  /// Whether packets are on their way at the present SystemC time. Whoever runs ahead of it then could miss a
  /// transfer that follows.
  virtual bool in_progress() const = 0;
};

/// May stay unbound: a network or a control unit also works without a host.
using HostTrafficPort = sc_core::sc_port<HostTraffic, 1, sc_core::SC_ZERO_OR_MORE_BOUND>;

}  // namespace model
