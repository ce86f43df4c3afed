#include "model/time/event_queue.hpp"

#include <algorithm>

#include "model/time/annotated_delay.hpp"

namespace model {

EventQueue::EventQueue(const sc_core::sc_module_name& name, const ClockDomain& clock)
    : sc_module(name), clock_(clock) {
  SC_HAS_PROCESS(EventQueue);
  SC_METHOD(run);
  sensitive << wake_;
  dont_initialize();
  for (std::vector<Task>& tasks : near_) tasks.reserve(kUsualTasks);
  join_other_chips(sc_core::sc_get_top_level_objects());
  if (!last_in_time_) last_in_time_ = std::make_shared<LastInTime>();
  place_ = last_in_time_->join();
}

EventQueue::EventQueue(const sc_core::sc_module_name& name, EventQueue& chip)
    : sc_module(name),
      clock_(chip.clock_),
      runs_tasks_(&chip),
      last_in_time_(chip.last_in_time_),
      place_(last_in_time_->join()) {}

void EventQueue::join_other_chips(const std::vector<sc_core::sc_object*>& objects) {
  for (sc_core::sc_object* const object : objects) {
    if (const auto* const other = dynamic_cast<const EventQueue*>(object); other != nullptr && other != this)
      last_in_time_ = other->last_in_time_;
    if (last_in_time_) return;
    join_other_chips(object->get_child_objects());
  }
}

Cycles EventQueue::cycle_after(const sc_core::sc_time& delay) const {
  const Cycles nearest = cycle_of_delay(clock_, delay);
  return clock_.time_at(nearest) < sc_core::sc_time_stamp() + delay ? nearest + 1 : nearest;
}

sc_core::sc_time EventQueue::delay_until(Cycles cycle) const {
  return model::delay_until(clock_, cycle);
}

void EventQueue::schedule(Cycles cycle, Task task) {
  if (runs_tasks_ != nullptr) return runs_tasks_->schedule(cycle, std::move(task));
  if (entries_ == 0 && !running_) first_ = std::max(first_, now());
  cycle = std::max(cycle, first_);
  ++entries_;
  if (cycle - first_ < kNear) {
    const std::size_t list = cycle % kNear;
    near_[list].push_back(std::move(task));
    near_filled_[list / 64] |= std::uint64_t{1} << (list % 64);
  } else {
    far_.push_back({cycle, asked_++, std::move(task)});
    std::push_heap(far_.begin(), far_.end(), later);
  }
  // SystemC keeps the earliest of several notifications.
  if (!running_) wake_.notify(delay_until(cycle));
}

void EventQueue::run() {
  running_ = true;
  while (entries_ > 0) {
    const Cycles next = next_cycle();
    if (clock_.time_at(next) > sc_core::sc_time_stamp()) break;
    first_ = next;
    do_tasks_of(next);
  }
  running_ = false;
  if (entries_ > 0) wake_.notify(delay_until(next_cycle()));
}

Cycles EventQueue::next_cycle() const {
  const Cycles near = next_near_cycle();
  return far_.empty() ? near : std::min(near, far_.front().cycle);
}

Cycles EventQueue::next_near_cycle() const {
  const std::size_t start = first_ % kNear;
  for (std::size_t i = 0; i <= near_filled_.size(); ++i) {
    const std::size_t word = (start / 64 + i) % near_filled_.size();
    std::uint64_t bits = near_filled_[word];
    if (i == 0) bits &= ~std::uint64_t{0} << (start % 64);
    if (bits == 0) continue;
    const std::size_t list = word * 64 + std::size_t(__builtin_ctzll(bits));
    return first_ + (list + kNear - start) % kNear;
  }
  return ~Cycles{0};
}

/// Tasks may schedule further ones in the same cycle.
void EventQueue::do_tasks_of(Cycles cycle) {
  while (!far_.empty() && far_.front().cycle == cycle) {
    std::pop_heap(far_.begin(), far_.end(), later);
    const Task task = std::move(far_.back().task);
    far_.pop_back();
    --entries_;
    task();
  }
  const std::size_t list = cycle % kNear;
  std::vector<Task>& tasks = near_[list];
  // A task may add to this list.
  for (std::size_t i = 0; i < tasks.size(); ++i) {  // NOLINT(modernize-loop-convert)
    const Task task = std::move(tasks[i]);
    --entries_;
    task();
  }
  tasks.clear();
  near_filled_[list / 64] &= ~(std::uint64_t{1} << (list % 64));
}

void EventQueue::pass_time_until(Cycles cycle) {
  const sc_core::sc_time delay = delay_until(cycle);
  if (delay != sc_core::SC_ZERO_TIME) sc_core::wait(delay);
  last_in_time_->come_last(place_);
}

void EventQueue::pass_time_until(const sc_core::sc_event& event) {
  sc_core::wait(event);
  last_in_time_->come_last(place_);
}

}  // namespace model
