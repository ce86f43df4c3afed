#include "model/control/thread_scheduler.hpp"

#include <algorithm>

#include "firmware/cn/machine.hpp"

namespace model {

ThreadScheduler::ThreadScheduler(int limit, int first_priority) : threads_(std::size_t(limit)) {
  start(first_priority, "first");
}

int ThreadScheduler::start(int priority, const std::string& name) {
  const auto slot = std::find_if(threads_.begin(), threads_.end(), [](const Thread& t) { return t.over; });
  if (slot == threads_.end())
    throw cn::MachineFault("no hardware thread left for '" + name + "': control.threads is " +
                           std::to_string(threads_.size()) + ", the firmware's first thread included");
  *slot = {name, priority, started_++, false, std::nullopt};
  ++alive_;
  return static_cast<int>(slot - threads_.begin());
}

void ThreadScheduler::run(int thread) {
  threads_[std::size_t(thread)].waits_for.reset();
  running_ = thread;
}

bool ThreadScheduler::any_waits_for(const std::function<bool(int semaphore)>& is_meant) const {
  return std::any_of(threads_.begin(), threads_.end(), [&](const Thread& thread) {
    return !thread.over && thread.waits_for && is_meant(*thread.waits_for);
  });
}

std::optional<Cycles> ThreadScheduler::ready_at(const Thread& thread, const SemaphoreFile& semaphores,
                                                Cycles now) const {
  if (thread.over) return std::nullopt;
  if (!thread.waits_for) return now;
  const std::optional<Cycles> signal = semaphores.first_signal(*thread.waits_for);
  return signal ? std::optional(std::max(now, *signal)) : std::nullopt;
}

bool ThreadScheduler::goes_before(const Thread& a, const Thread& b) const {
  return a.priority > b.priority || (a.priority == b.priority && a.order < b.order);
}

std::optional<ThreadScheduler::Ready> ThreadScheduler::next(const SemaphoreFile& semaphores,
                                                            Cycles now) const {
  std::optional<Ready> first;
  for (std::size_t slot = 0; slot < threads_.size(); ++slot) {
    const std::optional<Cycles> cycle = ready_at(threads_[slot], semaphores, now);
    if (!cycle) continue;
    if (!first || *cycle < first->cycle ||
        (*cycle == first->cycle && goes_before(threads_[slot], threads_[std::size_t(first->thread)])))
      first = Ready{static_cast<int>(slot), *cycle};
  }
  return first;
}

std::optional<int> ThreadScheduler::takes_over(const SemaphoreFile& semaphores, Cycles now) const {
  const std::optional<Ready> best = next(semaphores, now);
  if (!best || best->cycle > now) return std::nullopt;
  const Thread& running = threads_[std::size_t(running_)];
  if (threads_[std::size_t(best->thread)].priority <= running.priority) return std::nullopt;
  return best->thread;
}

std::string ThreadScheduler::waits(const std::vector<std::string>& semaphore_names) const {
  std::string text;
  for (const Thread& thread : threads_) {
    if (thread.over || !thread.waits_for) continue;
    text += (text.empty() ? "thread '" : ", thread '") + thread.name + "' waits on semaphore '" +
            semaphore_names.at(std::size_t(*thread.waits_for)) + "'";
  }
  return text;
}

}  // namespace model
