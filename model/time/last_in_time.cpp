#include "model/time/last_in_time.hpp"

#include <algorithm>

namespace model {

/// The stay of one process; hands the watch on at its end, also when the kernel ends the process.
class LastInTime::Wait {
 public:
  Wait(LastInTime& all, Member& member) : all_(all), member_(member) { member_.waits = true; }
  ~Wait() {
    member_.waits = false;
    all_.watched_ = false;
    const auto waits = [](const std::unique_ptr<Member>& member) { return member->waits; };
    if (std::any_of(all_.members_.begin(), all_.members_.end(), waits)) all_.let_watch(all_.first_waiting());
  }
  Wait(const Wait&) = delete;
  Wait& operator=(const Wait&) = delete;

 private:
  LastInTime& all_;
  Member& member_;
};

std::size_t LastInTime::join() {
  members_.push_back(std::make_unique<Member>());
  return members_.size() - 1;
}

void LastInTime::come_last(std::size_t place) {
  Member& self = *members_[place];
  const Wait stay(*this, self);
  if (watched_) sc_core::wait(self.turn);
  watched_ = true;
  for (;;) {
    while (sc_core::sc_pending_activity_at_current_time()) sc_core::wait(sc_core::SC_ZERO_TIME);
    const std::size_t first = first_waiting();
    if (first == place) return;
    let_watch(first);
    sc_core::wait(self.turn);
  }
}

std::size_t LastInTime::first_waiting() const {
  std::size_t place = 0;
  while (!members_[place]->waits) ++place;
  return place;
}

void LastInTime::let_watch(std::size_t place) {
  watched_ = true;
  members_[place]->turn.notify(sc_core::SC_ZERO_TIME);
}

}  // namespace model
