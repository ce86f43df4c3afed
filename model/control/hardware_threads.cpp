#include "model/control/hardware_threads.hpp"

#include "firmware/cn/machine.hpp"

namespace model {
namespace {

/// Takes a waiting thread off its stack when another one has failed. Firmware must not catch it, so it is no
/// std::exception.
struct ThreadStopped {};

}  // namespace

HardwareThreads::HardwareThreads(const ChipConfig::Control& config, CycleLedger& ledger,
                                 Semaphores& semaphores, TimeCoupling& time, const HostSemaphorePort& host,
                                 sc_core::sc_port<PioPort>& pio)
    : limit_(config.threads),
      switch_cycles_(Cycles(config.thread_switch_cycles)),
      ledger_(ledger),
      semaphores_(semaphores),
      time_(time),
      host_(host),
      pio_(pio),
      scheduler_(config.threads, cn::kFirstThreadPriority),
      processes_(config.threads, [this](const std::function<void()>& body) { run(body); }),
      wait_alone_(ledger, semaphores, time, host, pio) {}

void HardwareThreads::run_first(const std::function<void()>& body) {
  ledger_.report_thread(scheduler_.running(), ThreadState::running);
  run(body);
}

void HardwareThreads::begin_again() {
  scheduler_ = ThreadScheduler(limit_, cn::kFirstThreadPriority);
  finished_ = false;
}

void HardwareThreads::start(int priority, const std::string& name, std::function<void()> body) {
  const int thread = scheduler_.start(priority, name);
  processes_.add(thread, std::move(body));
  ledger_.report_thread(thread, ThreadState::ready);
}

void HardwareThreads::run(const std::function<void()>& body) {
  try {
    body();
    scheduler_.end();
    ledger_.report_thread(scheduler_.running(), ThreadState::none);
    if (scheduler_.alive() > 0) return processes_.wake(choose_thread());
    time_.synchronise();
  } catch (const sc_core::sc_unwind_exception&) {
    throw;  // the kernel ends this process
  } catch (const ThreadStopped&) {
    return;
  } catch (...) {
    failure_ = std::current_exception();  // SystemC would make a report of it and lose its type
    processes_.wake_all();                // they stop
  }
  finished_ = true;
  finished_event_.notify(sc_core::SC_ZERO_TIME);
}

void HardwareThreads::rethrow_failure() const {
  if (failure_) std::rethrow_exception(failure_);
}

void HardwareThreads::switch_to(int thread, int self) {
  processes_.switch_to(thread, self);
  if (failure_) throw ThreadStopped{};
}

/// Gives the control unit to `thread`, whose signal has arrived if it waited for one.
void HardwareThreads::dispatch(int thread) {
  if (const std::optional<int> semaphore = scheduler_.waits_for(thread)) semaphores_.take(*semaphore);
  if (thread != scheduler_.running()) {
    ++ledger_.statistics().thread_switches;
    ledger_.spend(CycleCause::thread_switch, switch_cycles_);
  }
  scheduler_.run(thread);
  ledger_.report_thread(thread, ThreadState::running);
}

void HardwareThreads::let_higher_priority_run() {
  if (scheduler_.alive() == 1) return;
  if (one_waits_for_host()) time_.synchronise();  // its signal must not come behind the running thread
  time_.settle_pio(ledger_.now());
  const std::optional<int> thread = scheduler_.takes_over(semaphores_.file(), ledger_.now());
  if (!thread) return;
  const int self = scheduler_.running();
  ledger_.report_thread(self, ThreadState::ready);
  dispatch(*thread);
  switch_to(*thread, self);
}

void HardwareThreads::wait(cn::Semaphore semaphore) {
  if (scheduler_.alive() > 1) return wait_among_threads(semaphore.index);
  ledger_.report_thread(scheduler_.running(), ThreadState::waiting);
  wait_alone_.wait(semaphore);
  ledger_.report_thread(scheduler_.running(), ThreadState::running);
}

void HardwareThreads::wait_among_threads(int semaphore) {
  if (semaphores_.file().has_signal(semaphore, ledger_.now())) {
    semaphores_.take(semaphore);
    return;
  }
  const int self = scheduler_.running();
  scheduler_.wait(semaphore);
  ledger_.report_thread(self, ThreadState::waiting);
  const int next = choose_thread();
  if (next != self) switch_to(next, self);
}

/// The control unit waits until a thread can run, and gives itself to that one. What it waited for is what
/// that thread waited for.
int HardwareThreads::choose_thread() {
  const ThreadScheduler::Ready next = wait_until_one_is_ready();
  if (next.cycle > ledger_.now()) {
    const int semaphore = scheduler_.waits_for(next.thread).value();
    ledger_.spend_until(next.cycle, semaphores_.cause_of_wait(semaphore), semaphore);
  }
  dispatch(next.thread);
  return next.thread;
}

/// All threads wait, so nobody queues a request before the first of them goes on: the engine may decide up to
/// that cycle, and without end while none is known. When one waits for the host, SystemC's time comes along,
/// and its signals with it.
ThreadScheduler::Ready HardwareThreads::wait_until_one_is_ready() {
  const bool host_answers = one_waits_for_host();
  if (host_answers) time_.synchronise();
  for (;;) {
    const std::optional<ThreadScheduler::Ready> first = scheduler_.next(semaphores_.file(), ledger_.now());
    if (first && first->cycle <= ledger_.now()) return *first;
    const std::optional<Cycles> request = pio_->next_start();
    const bool request_comes_first = request && (!first || *request < first->cycle);
    if (host_answers) {
      if (first && first->cycle <= time_.present()) return *first;
      time_.wait_for(host_.host_signalled(), request_comes_first ? request
                                             : first             ? std::optional(first->cycle)
                                                                 : std::nullopt);
    } else if (request_comes_first) {
      time_.serve_next_request();
    } else if (first) {
      return *first;
    } else {
      throw cn::MachineFault("deadlock at cycle " + std::to_string(ledger_.now()) + ": " +
                             scheduler_.waits(semaphores_.names()) + "; nothing will signal any of them");
    }
  }
}

bool HardwareThreads::one_waits_for_host() const {
  return scheduler_.any_waits_for([&](int semaphore) { return semaphores_.is_shared_with_host(semaphore); });
}

}  // namespace model
