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

/// Firmware threads without a clock: coroutines that change only where one cannot go on. Among those that
/// can, the highest priority runs, the one started first among equals.
///
/// They are ucontext's: part of the C library, and nothing runs at the same time, so the same order comes out
/// each time.
class NativeThreads {
 public:
  /// @param machine whose semaphores the threads wait for
  /// @param has_signal whether a semaphore has a signal to take
  NativeThreads(const cn::Machine& machine, std::function<bool(int semaphore)> has_signal)
      : machine_(machine), has_signal_(std::move(has_signal)) {}
  NativeThreads(const NativeThreads&) = delete;
  NativeThreads& operator=(const NativeThreads&) = delete;

  /// Runs `first` and all threads that it starts; throws what the one throws that fails before others, and
  /// cn::MachineFault when threads are left that cannot go on.
  void run(const std::function<void()>& first);

  /// Throws cn::MachineFault outside run().
  void start(int priority, const std::string& name, std::function<void()> body);

  /// Lets others run until `semaphore` has a signal; false when they cannot give one.
  bool wait(int semaphore);

 private:
  static constexpr std::size_t kStackBytes = 8 << 20;  ///< touched only as far as it is used
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
  /// Index of the thread to run; threads_.size() when none can.
  std::size_t next() const;
  void switch_to(std::size_t thread);
  void prepare(Thread& thread);
  void stop_others();
  /// "'loads' on semaphore 'full', ..."; empty when none waits.
  std::string waiting() const;

  const cn::Machine& machine_;
  std::function<bool(int)> has_signal_;
  std::vector<std::unique_ptr<Thread>> threads_;
  std::size_t running_ = 0;
  bool stopping_ = false;
  std::exception_ptr failure_;
};

}  // namespace testbench
