#pragma once

#include <functional>
#include <vector>

#include "model/pio/pio_service.hpp"
#include "model/pio/pio_transactions.hpp"
#include "model/pio/word_history.hpp"

namespace model {

/// Serves requests loosely timed, without processes: a request's whole time is booked when it starts. The
/// caller passes absolute cycles that do not go back. It must settle(t) before it lets SystemC time advance
/// to t, since TLM-2.0 delays cannot point to the past.
class LtPioService : public PioService {
 public:
  /// @param approach called with each request's start before its time is booked
  LtPioService(const ClockDomain& clock, int queue_depth, const PioTiming& timing, PioRequests& requests,
               PioTransactions& transactions, std::function<void(Cycles)> approach);

  void settle(Cycles now) override { start_due(now); }
  bool serve_next() override;
  std::optional<Cycles> next_start() const override;
  std::uint64_t words_moved_before(Cycles cycle) const override;
  Cycles make_room() override;
  void mono_changed() override {}

 private:
  void start(const PioQueue::Start& next) override;

  ClockDomain clock_;
  const PioTiming& timing_;
  PioTransactions& transactions_;
  std::function<void(Cycles)> approach_;
  std::vector<WordHistory> history_;  ///< by engine
};

}  // namespace model
