#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "model/control/semaphore_file.hpp"
#include "model/time/cycles.hpp"

namespace model {

/// Decides which hardware thread has the control unit (docs/csx600.md, section 1: fixed priority, switch when
/// the running thread waits on a semaphore). One runs; it goes on until it waits for a signal that has not
/// arrived, or until a thread of higher priority is ready. Among ready threads the highest priority runs,
/// among equals the one that was started first; equals do not take over from each other.
///
/// A thread is known by its slot, 0 to limit - 1; the slot of one that is over may be used again. The
/// firmware's first thread has slot 0 and runs from the beginning.
class ThreadScheduler {
 public:
  struct Ready {
    int thread;
    Cycles cycle;
  };

  /// @param limit hardware threads, the first one included
  ThreadScheduler(int limit, int first_priority);

  /// A thread that is ready at once; returns its slot. Throws cn::MachineFault when `limit` threads are not
  /// over yet.
  int start(int priority, const std::string& name);
  /// The running thread waits for `semaphore` from now on.
  void wait(int semaphore) { threads_[std::size_t(running_)].waits_for = semaphore; }
  /// The running thread is over.
  void end() {
    threads_[std::size_t(running_)].over = true;
    --alive_;
  }
  void run(int thread);

  /// The latest thread that was run, over or not.
  int running() const { return running_; }
  /// Threads that are not over.
  int alive() const { return alive_; }
  /// The semaphore that `thread` waits for; std::nullopt when it is ready.
  std::optional<int> waits_for(int thread) const { return threads_[std::size_t(thread)].waits_for; }
  bool any_waits_for(const std::function<bool(int semaphore)>& is_meant) const;

  /// The thread that can run next from `now` on, and when, by the signals that are known. std::nullopt when
  /// none can.
  std::optional<Ready> next(const SemaphoreFile& semaphores, Cycles now) const;
  /// A thread of higher priority than the running one that is ready at `now`; std::nullopt when there is
  /// none.
  std::optional<int> takes_over(const SemaphoreFile& semaphores, Cycles now) const;

  /// "thread 'loads' waits on semaphore 'full', thread 'first' ..." for a fault.
  std::string waits(const std::vector<std::string>& semaphore_names) const;

 private:
  struct Thread {
    std::string name;
    int priority = 0;
    std::uint64_t order = 0;  ///< how many were started before it
    bool over = true;
    std::optional<int> waits_for;
  };

  std::optional<Cycles> ready_at(const Thread& thread, const SemaphoreFile& semaphores, Cycles now) const;
  bool goes_before(const Thread& a, const Thread& b) const;

  std::vector<Thread> threads_;
  int running_ = 0;
  int alive_ = 0;
  std::uint64_t started_ = 0;
};

}  // namespace model
