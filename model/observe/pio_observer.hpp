#pragma once

#include <cstdint>

#include "firmware/cn/chip/lane_mask.hpp"
#include "firmware/cn/chip/transfer.hpp"
#include "model/time/cycles.hpp"

namespace model {

/// One request as waves and logs see it.
struct PioEvent {
  std::uint64_t id = 0;  ///< ascending from 0 in the order of enqueueing
  cn::Direction direction = cn::Direction::mono_to_poly;
  std::uint64_t bytes = 0;  ///< moved in all PEs
  int pes = 0;              ///< PEs that take part
  Cycles enqueued = 0;
  Cycles started = 0;
  Cycles finished = 0;
  int semaphore = -1;
  int queue_depth = 0;                    ///< requests that wait when this one has started
  cn::Label label{};                      ///< bin and block that it belongs to
  const cn::LaneMask* enabled = nullptr;  ///< PEs that take part; valid during the call
};

/// Told about requests when their times are decided, which is ahead of SystemC time and in the order of
/// `started`.
class PioObserver {
 public:
  virtual ~PioObserver() = default;
  virtual void started(const PioEvent& event) = 0;   ///< `finished` is not yet known and 0
  virtual void finished(const PioEvent& event) = 0;  ///< right after `started`, with all times
};

struct PioStatistics {
  std::uint64_t requests_to_poly = 0;
  std::uint64_t requests_to_mono = 0;
  std::uint64_t bytes_to_poly = 0;
  std::uint64_t bytes_to_mono = 0;
  std::uint64_t pes = 0;             ///< PEs that took part, summed over requests
  std::uint64_t empty_requests = 0;  ///< without an enabled PE; not among the others
  std::uint64_t setup_cycles = 0;
  std::uint64_t pe_cycles = 0;           ///< taking PEs one by one, misalignment included
  std::uint64_t memory_wait_cycles = 0;  ///< in service while the PE side is done or waits for memory
  std::uint64_t queue_wait_cycles = 0;   ///< from enqueueing to the start, summed over requests
  std::uint64_t blocked_cycles = 0;      ///< the control unit stood before a full queue
  int max_queue_depth = 0;
  std::uint64_t late_starts =
      0;  ///< requests booked when SystemC time had passed their start; 0 unless settle() was forgotten

  /// Cycles in service, of both engines together if there are two.
  std::uint64_t busy_cycles() const { return setup_cycles + pe_cycles + memory_wait_cycles; }
};

}  // namespace model
