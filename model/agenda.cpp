#include "model/agenda.hpp"

#include <algorithm>

#include "model/annotated_delay.hpp"

namespace model {

Agenda::Agenda(const sc_core::sc_module_name& name, const ClockDomain& clock)
    : sc_module(name), clock_(clock) {
  SC_HAS_PROCESS(Agenda);
  SC_METHOD(run);
  sensitive << wake_;
  dont_initialize();
}

Cycles Agenda::cycle_after(const sc_core::sc_time& delay) const {
  const Cycles nearest = cycle_of_delay(clock_, delay);
  return clock_.time_at(nearest) < sc_core::sc_time_stamp() + delay ? nearest + 1 : nearest;
}

sc_core::sc_time Agenda::delay_until(Cycles cycle) const {
  return model::delay_until(clock_, cycle);
}

void Agenda::at(Cycles cycle, Task task) {
  entries_.push_back({cycle, asked_++, std::move(task)});
  std::push_heap(entries_.begin(), entries_.end(), later);
  if (!running_) wake_for_next();
}

void Agenda::run() {
  running_ = true;
  while (!entries_.empty() && clock_.time_at(entries_.front().cycle) <= sc_core::sc_time_stamp()) {
    std::pop_heap(entries_.begin(), entries_.end(), later);
    const Task task = std::move(entries_.back().task);
    entries_.pop_back();
    task();
  }
  running_ = false;
  if (!entries_.empty()) wake_for_next();
}

/// Of several notifications SystemC keeps the earliest.
void Agenda::wake_for_next() {
  wake_.notify(delay_until(entries_.front().cycle));
}

void Agenda::pass_time_until(Cycles cycle) {
  const sc_core::sc_time delay = delay_until(cycle);
  if (delay != sc_core::SC_ZERO_TIME) sc_core::wait(delay);
  come_last();
}

void Agenda::pass_time_until(const sc_core::sc_event& event) {
  sc_core::wait(event);
  come_last();
}

void Agenda::come_last() {
  while (sc_core::sc_pending_activity_at_current_time()) sc_core::wait(sc_core::SC_ZERO_TIME);
}

}  // namespace model
