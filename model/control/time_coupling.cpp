#include "model/control/time_coupling.hpp"

#include <tlm>

namespace model {

std::optional<sc_core::sc_time> TimeCoupling::allowed_lead() const {
  if (timing_ == TimingStyle::approximately_timed) return std::nullopt;  // it is never ahead of an access
  const sc_core::sc_time& quantum = tlm::tlm_global_quantum::instance().get();
  if (memory_is_shared_ || quantum != sc_core::SC_ZERO_TIME) return quantum;
  return std::nullopt;
}

void TimeCoupling::approach(Cycles cycle) {
  const std::optional<sc_core::sc_time> lead = allowed_lead();
  if (lead && clock_.time_at(cycle) > sc_core::sc_time_stamp() + *lead) wait_until(cycle);
}

void TimeCoupling::settle_pio_beside_host(Cycles cycle) {
  for (auto next = pio_->next_start(); host_is_transferring() && next && *next <= cycle;
       next = pio_->next_start()) {
    wait_behind_host(*next);
    pio_->settle(*next);
  }
  if (host_is_transferring()) wait_behind_host(cycle);
}

bool TimeCoupling::serve_next_request() {
  const std::optional<Cycles> next = pio_->next_start();
  if (!next || !host_is_transferring()) return pio_->serve_next();
  settle_pio(*next);
  return true;
}

void TimeCoupling::synchronise() {
  settle_pio(ledger_.now());
  wait_until(ledger_.now());
}

void TimeCoupling::wait_for(const sc_core::sc_event& event, std::optional<Cycles> at_the_latest) {
  if (at_the_latest) {
    book_until(booked_traffic_, *at_the_latest);
    sc_core::wait(clock_.time_at(*at_the_latest) - sc_core::sc_time_stamp(), event);
  } else {
    sc_core::wait(event);
  }
  pio_->settle(present());
}

void TimeCoupling::wait_behind_host(Cycles cycle) {
  wait_until(cycle);
  sc_core::wait(sc_core::SC_ZERO_TIME);
}

void TimeCoupling::wait_until(Cycles cycle) {
  book_until(booked_traffic_, cycle);
  const sc_core::sc_time target = clock_.time_at(cycle);
  if (target > sc_core::sc_time_stamp()) sc_core::wait(target - sc_core::sc_time_stamp());
}

}  // namespace model
