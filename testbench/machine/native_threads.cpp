#include "testbench/machine/native_threads.hpp"

#include <cstdint>

namespace testbench {
namespace {

/// Thrown in a waiting thread to unwind its stack after another thread has failed. Not a std::exception, so
/// that firmware does not catch it.
struct ThreadStopped {};

}  // namespace

void NativeThreads::run(const std::function<void()>& first) {
  threads_.clear();
  stopping_ = false;
  failure_ = nullptr;
  running_ = kFirst;
  threads_.push_back(std::make_unique<Thread>());
  Thread& thread = *threads_[kFirst];
  thread.name = "first";
  thread.priority = cn::kFirstThreadPriority;
  thread.entered = true;
  try {
    first();
    thread.over = true;
    // Threads of lower priority and threads signalled last may still have to run.
    for (std::size_t other = next(); other < threads_.size(); other = next()) switch_to(other);
  } catch (const ThreadStopped&) {  // failure_ holds the reason
  } catch (...) {
    if (!failure_) failure_ = std::current_exception();
  }
  if (!failure_ && !waiting().empty())
    failure_ = std::make_exception_ptr(cn::MachineFault("no thread can go on: " + waiting()));
  stop_others();
  threads_.clear();
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

void NativeThreads::start(int priority, const std::string& name, std::function<void()> body) {
  if (threads_.empty())
    throw cn::MachineFault("start of thread '" + name + "' outside NativeMachine::run_firmware");
  auto thread = std::make_unique<Thread>();
  thread->priority = priority;
  thread->name = name;
  thread->body = std::move(body);
  threads_.push_back(std::move(thread));
}

bool NativeThreads::wait(int semaphore) {
  if (threads_.empty()) return false;
  const std::size_t self = running_;
  threads_[self]->waits_for = semaphore;
  const std::size_t other = next();
  if (other == threads_.size()) return false;
  switch_to(other);
  threads_[self]->waits_for = -1;
  return has_signal_(semaphore);
}

std::size_t NativeThreads::next() const {
  std::size_t best = threads_.size();
  for (std::size_t i = 0; i < threads_.size(); ++i) {
    const Thread& thread = *threads_[i];
    if (thread.over || (thread.waits_for >= 0 && !has_signal_(thread.waits_for))) continue;
    if (best == threads_.size() || thread.priority > threads_[best]->priority) best = i;
  }
  return best;
}

std::string NativeThreads::waiting() const {
  std::string names;
  for (const auto& thread : threads_)
    if (!thread->over && thread->waits_for >= 0)
      names += (names.empty() ? "'" : ", '") + thread->name + "' waits on semaphore '" +
               machine_.semaphore_name({thread->waits_for}) + "'";
  return names;
}

/// Returns when another thread switches back to this one.
void NativeThreads::switch_to(std::size_t thread) {
  Thread& from = *threads_[running_];
  Thread& to = *threads_[thread];
  running_ = thread;
  if (!to.entered) prepare(to);
  swapcontext(&from.context, &to.context);
  if (stopping_) throw ThreadStopped{};
}

void NativeThreads::prepare(Thread& thread) {
  thread.entered = true;
  thread.stack.reset(new std::byte[kStackBytes]);  // not zeroed, so that only used pages take memory
  getcontext(&thread.context);
  thread.context.uc_stack.ss_sp = thread.stack.get();
  thread.context.uc_stack.ss_size = kStackBytes;
  thread.context.uc_link = nullptr;
  const auto self = reinterpret_cast<std::uintptr_t>(this);  // makecontext() passes only values of type int
  makecontext(&thread.context, reinterpret_cast<void (*)()>(&NativeThreads::enter), 2, unsigned(self >> 32),
              unsigned(self & 0xffffffffu));
}

void NativeThreads::enter(unsigned high, unsigned low) {
  reinterpret_cast<NativeThreads*>((std::uintptr_t(high) << 32) | low)->run_body();
}

/// After its body has ended, a thread switches to the next one that can continue, else to the first one,
/// which handles the end or a failure.
void NativeThreads::run_body() {
  Thread& self = *threads_[running_];
  try {
    self.body();
  } catch (const ThreadStopped&) {
  } catch (...) {
    failure_ = std::current_exception();
    stopping_ = true;
  }
  self.over = true;
  const std::size_t other = stopping_ ? kFirst : next();
  running_ = other < threads_.size() ? other : kFirst;
  Thread& to = *threads_[running_];
  if (!to.entered) prepare(to);
  setcontext(&to.context);
}

/// Resumes each waiting thread, which unwinds its stack and returns to the first.
void NativeThreads::stop_others() {
  stopping_ = true;
  for (std::size_t i = 1; i < threads_.size(); ++i) {
    Thread& thread = *threads_[i];
    if (thread.over || !thread.entered) continue;
    running_ = i;
    swapcontext(&threads_[kFirst]->context, &thread.context);
  }
}

}  // namespace testbench
