#include "model/control/wait_record.hpp"

#include <algorithm>

namespace model {
namespace {

constexpr Waiter kAllWaiters[kWaiters] = {Waiter::control_unit, Waiter::host};

const char* name_of(Waiter waiter) {
  return waiter == Waiter::control_unit ? "the control unit" : "the host";
}

const char* name_of(Signaller by) {
  switch (by) {
    case Signaller::control_unit:
      return "the control unit";
    case Signaller::host:
      return "the host";
    case Signaller::pio:
      break;
  }
  return "a PIO request";
}

std::string at_cycle(Cycles cycle) {
  return " at cycle " + std::to_string(cycle);
}

std::string quoted(int semaphore, const std::vector<std::string>& names) {
  const auto index = std::size_t(semaphore);
  return index < names.size() ? "'" + names[index] + "'" : std::to_string(semaphore);
}

}  // namespace

void WaitRecord::waits(Waiter waiter, cn::Semaphore semaphore, Cycles since) {
  Wait& wait = waits_[std::size_t(waiter)];
  if (wait.semaphore == semaphore.index) return;  // it only looked again
  wait.semaphore = semaphore.index;
  wait.since = since;
}

void WaitRecord::goes_on(Waiter waiter, Cycles at) {
  Wait& wait = waits_[std::size_t(waiter)];
  wait.taken = wait.semaphore;
  wait.taken_at = at;
  wait.semaphore.reset();
}

void WaitRecord::started(const cn::Transfer& transfer, Cycles at) {
  Started& started = started_[std::size_t(transfer.done.index)];
  ++started.count;
  started.direction = transfer.direction;
  started.at = at;
}

void WaitRecord::clear() {
  const auto shared = shared_with_host_;
  *this = {};
  shared_with_host_ = shared;
}

bool WaitRecord::has_host() const {
  return std::find(shared_with_host_.begin(), shared_with_host_.end(), true) != shared_with_host_.end();
}

std::string WaitRecord::deadlock(Cycles now, const SemaphoreFile& semaphores,
                                 const std::vector<std::string>& names) const {
  std::string report = summary(now, names);
  for (const Waiter waiter : kAllWaiters)
    if (waiter == Waiter::control_unit || has_host()) report += waiter_line(waiter, semaphores, names);
  return report + unclaimed_line(semaphores, names);
}

std::string WaitRecord::summary(Cycles now, const std::vector<std::string>& names) const {
  std::string line = "deadlock" + at_cycle(now) + ":";
  const char* separator = " ";
  for (const Waiter waiter : kAllWaiters) {
    const Wait& wait = waits_[std::size_t(waiter)];
    if (!wait.semaphore) continue;
    line +=
        separator + std::string(name_of(waiter)) + " waits for semaphore " + quoted(*wait.semaphore, names);
    separator = ", ";
  }
  return line + ", which no outstanding transfer will signal";
}

std::string WaitRecord::waiter_line(Waiter waiter, const SemaphoreFile& semaphores,
                                    const std::vector<std::string>& names) const {
  const Wait& wait = waits_[std::size_t(waiter)];
  std::string line = "\n  " + std::string(name_of(waiter));
  if (!wait.semaphore) {
    line += " waits for no semaphore";
    if (wait.taken) line += "; it took one of " + quoted(*wait.taken, names) + at_cycle(wait.taken_at);
    return line;
  }
  line += " waits since cycle " + std::to_string(wait.since) + " for semaphore " +
          std::to_string(*wait.semaphore);
  if (std::size_t(*wait.semaphore) < names.size()) line += " " + quoted(*wait.semaphore, names);
  line += ", count " + std::to_string(semaphores.count(*wait.semaphore)) + "; " +
          candidates(waiter, *wait.semaphore) + "; " + history(*wait.semaphore);
  if (waiter == Waiter::control_unit)
    line += last_kernel_ == nullptr
                ? "; no kernel has run"
                : "; last kernel '" + std::string(last_kernel_) + "', ended" + at_cycle(last_kernel_cycle_);
  return line;
}

std::string WaitRecord::candidates(Waiter waiter, int semaphore) const {
  const bool shared = shared_with_host_[std::size_t(semaphore)];
  if (waiter == Waiter::control_unit && !shared) return "nobody is left who could signal it";
  const Waiter other = waiter == Waiter::control_unit ? Waiter::host : Waiter::control_unit;
  const Wait& wait_of_other = waits_[std::size_t(other)];
  return std::string(name_of(other)) + " could signal it" +
         (wait_of_other.semaphore ? ", but waits itself" : ", but does nothing any more");
}

std::string WaitRecord::history(int semaphore) const {
  const auto index = std::size_t(semaphore);
  std::string text = last_signal_[index]
                         ? "last signalled by " + std::string(name_of(last_signal_[index]->by)) +
                               at_cycle(last_signal_[index]->at)
                         : "never signalled";
  const Started& started = started_[index];
  if (started.count == 0) return text + ", no transfer was started on it";
  return text + ", " + std::to_string(started.count) +
         (started.count == 1 ? " transfer was" : " transfers were") + " started on it, the last a " +
         (started.direction == cn::Direction::mono_to_poly ? "load" : "save") + at_cycle(started.at);
}

std::string WaitRecord::unclaimed_line(const SemaphoreFile& semaphores,
                                       const std::vector<std::string>& names) const {
  std::string line;
  for (int semaphore = 0; semaphore < cn::Machine::kSemaphores; ++semaphore)
    if (const int count = semaphores.count(semaphore))
      line += (line.empty() ? "\n  signals that nobody has taken: " : ", ") + std::to_string(count) + " of " +
              quoted(semaphore, names);
  return line;
}

}  // namespace model
