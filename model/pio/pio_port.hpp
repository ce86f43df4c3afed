#pragma once

#include <optional>
#include <systemc>

#include "firmware/cn/chip/transfer.hpp"
#include "model/time/clock_domain.hpp"

namespace model {

/// The programmed-I/O engine as the control unit drives it. Loosely timed: the control unit runs ahead of
/// SystemC time and passes its own cycle; once it has asked the engine to settle a cycle, what the engine
/// decided for it no longer changes.
class PioPort : public virtual sc_core::sc_interface {
 public:
  /// Queues a request at `now`; returns the cycle at which the control unit may go on (later than `now` when
  /// the queue was full).
  virtual Cycles enqueue(const cn::Transfer& transfer, Cycles now) = 0;

  /// Starts every queued request that is due at or before `now`.
  virtual void settle(Cycles now) = 0;

  /// Serves the next queued request, whenever it starts; false when none is queued. For a control unit that
  /// waits, so that no other request can come before.
  virtual bool serve_next() = 0;

  /// When the next queued request starts, if no other is queued before; std::nullopt when none waits.
  virtual std::optional<Cycles> next_start() const = 0;

  /// 8-byte words that went through PEs' SRAM ports before `cycle` (which must be settled); monotonic.
  virtual std::uint64_t words_moved_before(Cycles cycle) const = 0;
};

/// Where the engine reports a finished request: semaphore `index` is signalled at `at`.
class SemaphorePort : public virtual sc_core::sc_interface {
 public:
  virtual void signal_at(int index, Cycles at) = 0;
};

/// SystemC time as the engine asks for it, loosely timed: the process that drives the engine lets it pass.
class TimePort : public virtual sc_core::sc_interface {
 public:
  /// To be called before `cycle` is booked on what other initiators may book, too.
  virtual void approach(Cycles cycle) = 0;
};

}  // namespace model
