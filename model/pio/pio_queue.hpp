#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "firmware/cn/chip/transfer.hpp"
#include "model/config/chip_config.hpp"
#include "model/time/cycles.hpp"

namespace model {

/// Decides which queued request is served next, and when. It holds requests that wait, not those in service.
///
/// - strict_fifo: in the order of arrival.
/// - reads_overtake_writes: when the engine gets free, the oldest read goes first, otherwise the oldest
///   write. A read is seen if it was queued before that cycle; one queued in the very cycle comes too late.
/// - queue_per_direction: each direction has a queue of `depth` and an engine of its own; requests start in
///   the order of their start cycles, the older one first when equal.
///
/// The choice for a cycle depends only on requests queued before it (or on the one that finds the engine
/// idle), so it stays the same however often the engine is asked.
class PioQueue {
 public:
  struct Entry {
    std::uint64_t id;  ///< ascending in the order of arrival
    cn::Direction direction;
    Cycles enqueued;
    int slot;  ///< the caller's own number
  };
  struct Start {
    Entry entry;
    Cycles cycle;
  };

  PioQueue(PioArbitration arbitration, int depth);

  bool full(cn::Direction direction) const;
  int waiting() const { return static_cast<int>(engine_[0].queue.size() + engine_[1].queue.size()); }
  /// Whether a request may start at a cycle up to `now`. Fast, since the control unit asks at every
  /// operation.
  bool may_start(Cycles now) const {
    return (!engine_[0].queue.empty() && engine_[0].free <= now) ||
           (!engine_[1].queue.empty() && engine_[1].free <= now);
  }
  /// The queue of that direction must not be full.
  void push(const Entry& entry);
  /// The next request to start if no other arrives before; std::nullopt when none waits.
  std::optional<Start> next() const;
  /// Takes that request out of the queue; its engine is busy until `finish`.
  void begin(const Start& start, Cycles finish);
  /// The same when the end is not known yet: the engine starts no request before finish().
  void begin(const Start& start) { begin(start, kNotYetKnown); }
  void finish(int engine, Cycles finish) { engine_[std::size_t(engine)].free = finish; }

  int engines() const { return arbitration_ == PioArbitration::queue_per_direction ? 2 : 1; }
  int engine_of(cn::Direction direction) const { return engines() == 1 ? 0 : static_cast<int>(direction); }

 private:
  static constexpr Cycles kNotYetKnown = ~Cycles{0};
  struct Engine {
    std::vector<Entry> queue;  ///< in the order of arrival
    Cycles free = 0;
  };

  Start next_of(const Engine& engine) const;

  PioArbitration arbitration_;
  std::size_t depth_;
  std::array<Engine, 2> engine_;
};

}  // namespace model
