#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "model/config/chip_config.hpp"
#include "model/observe/pio_observer.hpp"
#include "model/pio/pio_queue.hpp"
#include "model/pio/pio_request.hpp"
#include "model/pio/pio_timing.hpp"

namespace model {

/// The requests that the engine holds, waiting or in service, and their record: counts them, tells the
/// observer of their starts and ends, and signals their semaphores.
class PioRequests {
 public:
  using Signal = std::function<void(int semaphore, Cycles at)>;

  PioRequests(const ChipConfig::Pio& config, const PioTiming& timing, Signal signal);

  std::uint64_t next_id() const { return next_id_; }
  /// Storage for the next request, if its queue is not full. It stays unused until the request is queued.
  PioRequest& unused() { return requests_[std::size_t(free_slots_.back())]; }
  bool full(cn::Direction direction) const { return queue_.full(direction); }
  /// Queues `request`, the storage from unused(), whose addresses are described.
  void push(PioRequest& request, const cn::Transfer& transfer, Cycles accepted);

  int waiting() const { return queue_.waiting(); }
  bool may_start(Cycles now) const { return queue_.may_start(now); }
  std::optional<PioQueue::Start> next() const { return queue_.next(); }
  int engines() const { return queue_.engines(); }
  int engine_of(const PioQueue::Start& start) const { return queue_.engine_of(start.entry.direction); }
  PioRequest& request_of(const PioQueue::Start& start) { return requests_[std::size_t(start.entry.slot)]; }

  /// The request is in service from start.cycle to `finish`: begun and ended in one step.
  void serve(const PioQueue::Start& start, Cycles finish);
  /// The request is in service from start.cycle on; end() tells until when.
  void begin(const PioQueue::Start& start);
  void end(PioRequest& request, int engine, Cycles finish);
  /// A request that has nothing to do: only signals.
  void skip(const cn::Transfer& transfer, Cycles now);

  void set_observer(PioObserver* observer) { observer_ = observer; }
  PioStatistics& statistics() { return statistics_; }
  const PioStatistics& statistics() const { return statistics_; }

 private:
  void record_start(PioRequest& request, const PioQueue::Start& start);
  void record_end(PioRequest& request, Cycles finish);
  void count(const PioEvent& event, Cycles pe_cycles);
  void signal(cn::Semaphore done, Cycles at);

  const PioTiming& timing_;
  Signal signal_;
  PioQueue queue_;
  std::vector<PioRequest> requests_;  ///< a pool, because storage of addresses is reused
  std::vector<int> free_slots_;
  std::uint64_t next_id_ = 0;
  PioObserver* observer_ = nullptr;
  PioStatistics statistics_;
};

}  // namespace model
