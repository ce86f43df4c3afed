#include "model/control/control_unit.hpp"

namespace model {
namespace {

/// Takes a waiting thread off its stack when another one has failed. Firmware must not catch it, so it is no
/// std::exception.
struct ThreadStopped {};

}  // namespace

void ControlUnit::start_thread(int priority, const std::string& name, std::function<void()> body) {
  if (at_transport_)
    throw cn::MachineFault("start of thread '" + name +
                           "': an approximately timed chip runs one hardware thread; run it loosely timed");
  const int slot = threads_.start(priority, name);
  // An aggregate with an event cannot move, so there is no make_unique of it.
  // NOLINTBEGIN(modernize-make-unique)
  if (!processes_[0]) processes_[0].reset(new ThreadProcess{{}, true, {}});
  processes_[std::size_t(slot)].reset(new ThreadProcess{std::move(body), false, {}});
  // NOLINTEND(modernize-make-unique)
  report_thread(slot, ThreadState::ready);
  if (timed_) let_higher_priority_run();
}

void ControlUnit::run_thread(const std::function<void()>& body) {
  try {
    body();
    threads_.end();
    report_thread(threads_.running(), ThreadState::none);
    if (threads_.alive() > 0) return wake(choose_thread());
    synchronise();
  } catch (const sc_core::sc_unwind_exception&) {
    throw;  // the kernel ends this process
  } catch (const ThreadStopped&) {
    return;
  } catch (...) {
    failure_ = std::current_exception();  // SystemC would make a report of it and lose its type
    stop_other_threads();
  }
  finished_ = true;
  finished_event_.notify(sc_core::SC_ZERO_TIME);
}

void ControlUnit::wake(int thread) {
  ThreadProcess& process = *processes_[std::size_t(thread)];
  if (process.spawned) return process.go_on.notify();
  process.spawned = true;
  sc_core::sc_spawn_options options;
  options.set_stack_size(kFirmwareStackBytes);
  sc_core::sc_spawn([this, &process] { run_thread(process.body); },
                    sc_core::sc_gen_unique_name("firmware_thread"), &options);
}

void ControlUnit::switch_to(int thread, int self) {
  wake(thread);
  wait(processes_[std::size_t(self)]->go_on);
  if (failure_) throw ThreadStopped{};
}

void ControlUnit::stop_other_threads() {
  for (const auto& process : processes_)
    if (process && process->spawned) process->go_on.notify();
}

/// Gives the control unit to `thread`, whose signal has arrived if it waited for one.
void ControlUnit::dispatch(int thread) {
  if (const std::optional<int> semaphore = threads_.waits_for(thread)) semaphore_file_.take(*semaphore);
  if (thread != threads_.running()) {
    ++statistics_.thread_switches;
    spend(CycleCause::thread_switch, Cycles(config_.control.thread_switch_cycles));
  }
  threads_.run(thread);
  report_thread(thread, ThreadState::running);
}

void ControlUnit::let_higher_priority_run() {
  if (threads_.alive() == 1) return;
  if (a_thread_waits_for_host()) synchronise();  // its signal must not come behind the running thread
  settle_pio(now_);
  const std::optional<int> thread = threads_.takes_over(semaphore_file_, now_);
  if (!thread) return;
  const int self = threads_.running();
  report_thread(self, ThreadState::ready);
  dispatch(*thread);
  switch_to(*thread, self);
}

void ControlUnit::wait_among_threads(cn::Semaphore semaphore) {
  if (semaphore_file_.has_signal(semaphore.index, now_)) {
    semaphore_file_.take(semaphore.index);
    return;
  }
  const int self = threads_.running();
  threads_.wait(semaphore.index);
  report_thread(self, ThreadState::waiting);
  const int next = choose_thread();
  if (next != self) switch_to(next, self);
}

/// The control unit waits until a thread can run, and gives itself to that one. What it waited for is what
/// that thread waited for.
int ControlUnit::choose_thread() {
  const ThreadScheduler::Ready next = wait_until_a_thread_is_ready();
  if (next.cycle > now_) {
    const int semaphore = threads_.waits_for(next.thread).value();
    spend(cause_of_wait({semaphore}), next.cycle - now_, semaphore);
  }
  dispatch(next.thread);
  return next.thread;
}

/// All threads wait, so nobody queues a request before the first of them goes on: the engine may decide up to
/// that cycle, and on and on while none is known. When one waits for the host, SystemC's time comes along,
/// and its signals with it.
ThreadScheduler::Ready ControlUnit::wait_until_a_thread_is_ready() {
  const bool host_answers = a_thread_waits_for_host();
  if (host_answers) synchronise();
  for (;;) {
    const std::optional<ThreadScheduler::Ready> first = threads_.next(semaphore_file_, now_);
    if (first && first->cycle <= now_) return *first;
    const std::optional<Cycles> request = pio->next_start();
    const bool request_comes_first = request && (!first || *request < first->cycle);
    if (host_answers) {
      if (first && first->cycle <= clock_.cycle_at(sc_core::sc_time_stamp())) return *first;
      wait_for_host_event(request_comes_first ? request : first ? std::optional(first->cycle) : std::nullopt);
    } else if (request_comes_first) {
      serve_next_request();
    } else if (first) {
      return *first;
    } else {
      throw cn::MachineFault("deadlock at cycle " + std::to_string(now_) + ": " +
                             threads_.waits(semaphore_names()) + "; nothing will signal any of them");
    }
  }
}

bool ControlUnit::a_thread_waits_for_host() const {
  return threads_.any_waits_for([&](int semaphore) { return shared_with_host_[std::size_t(semaphore)]; });
}

}  // namespace model
