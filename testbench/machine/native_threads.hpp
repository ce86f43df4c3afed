#pragma once

#include <ucontext.h>
#include <cstddef>
#include <exception>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "firmware/cn/machine.hpp"

namespace testbench {

/// Firmware threads without a clock: coroutines that switch only where the running one must wait. Of the
/// threads that can continue, the one with the highest priority runs, and among equals the one started first.
///
/// They use the C library's ucontext. No two threads run at the same time, so their order is the same in
/// every run.
class NativeThreads {
 public:
  /// @param machine names the semaphores in messages
  /// @param has_signal whether a semaphore has a signal to take
  NativeThreads(const cn::Machine& machine, std::function<bool(int semaphore)> has_signal)
      : machine_(machine), has_signal_(std::move(has_signal)) {}
  NativeThreads(const NativeThreads&) = delete;
  NativeThreads& operator=(const NativeThreads&) = delete;

  /// Runs `first` and all threads that it starts. Rethrows the exception of the first thread that fails.
  /// Throws cn::MachineFault when only threads remain that wait without end.
  void run(const std::function<void()>& first);

  /// Throws cn::MachineFault outside run().
  void start(int priority, const std::string& name, std::function<void()> body);

  /// Lets other threads run until `semaphore` has a signal. Returns false if none of them can signal it.
  bool wait(int semaphore);

 private:
  static constexpr std::size_t kStackBytes =
      8 << 20;  ///< the operating system provides only the pages that are used
  struct Thread {
    int priority = 0;
    std::string name;
    std::function<void()> body;
    int waits_for = -1;
    bool over = false;
    bool entered = false;
    ucontext_t context{};
    std::unique_ptr<std::byte[]> stack;
  };
  static constexpr std::size_t kFirst = 0;

  static void enter(unsigned high, unsigned low);
  void run_body();
  /// Index of the thread to run next; threads_.size() if none can continue.
  std::size_t next() const;
  void switch_to(std::size_t thread);
  void prepare(Thread& thread);
  void stop_others();
  /// Lists the waiting threads: "'loads' waits on semaphore 'full', ..."; empty if no thread waits.
  std::string waiting() const;

  const cn::Machine& machine_;
  std::function<bool(int)> has_signal_;
  std::vector<std::unique_ptr<Thread>> threads_;
  std::size_t running_ = 0;
  bool stopping_ = false;
  std::exception_ptr failure_;
};

}  // namespace testbench
