#pragma once

#include <cstdint>
#include <optional>

#include "model/pio/pio_requests.hpp"
#include "model/time/cycles.hpp"

namespace model {

/// How queued requests are served: the one difference between a loosely timed engine (LtPioService) and an
/// approximately timed one (AtPioService).
class PioService {
 public:
  virtual ~PioService() = default;
  PioService(const PioService&) = delete;
  PioService& operator=(const PioService&) = delete;

  // As in PioPort:
  virtual void settle(Cycles now) = 0;
  virtual bool serve_next() = 0;
  virtual std::optional<Cycles> next_start() const = 0;
  virtual std::uint64_t words_moved_before(Cycles cycle) const = 0;

  /// For a queue that is full: returns when the next queued request has started.
  virtual Cycles make_room() = 0;
  /// Told that a request that was just queued has changed data in mono memory.
  virtual void mono_changed() = 0;

  /// Starts every queued request that is due at or before `now`.
  void start_due(Cycles now) {
    if (!requests_.may_start(now)) return;
    for (auto next = requests_.next(); next && next->cycle <= now; next = requests_.next()) start(*next);
  }

 protected:
  explicit PioService(PioRequests& requests) : requests_(requests) {}

  virtual void start(const PioQueue::Start& next) = 0;

  PioRequests& requests_;
};

}  // namespace model
