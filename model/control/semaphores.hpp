#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware/cn/chip/transfer.hpp"
#include "model/control/semaphore_file.hpp"
#include "model/control/wait_record.hpp"
#include "model/observe/control_observer.hpp"

namespace model {

/// The chip's semaphores with what is known of them: their signals (SemaphoreFile), and who waits for them
/// and signals them (WaitRecord).
class Semaphores {
 public:
  /// @param names of the semaphores that the firmware has allocated, which must outlive this
  explicit Semaphores(const std::vector<std::string>& names) : names_(names) {}

  void share_with_host(cn::Semaphore semaphore) { record_.share_with_host(semaphore); }
  /// No signal is left and none was given; the host shares what it shared.
  void clear() {
    file_ = {};
    record_.clear();
  }
  bool is_shared_with_host(int semaphore) const { return record_.is_shared_with_host(semaphore); }

  void signal(int semaphore, Signaller by, Cycles at) {
    file_.signal(semaphore, at);
    record_.signalled(semaphore, by, at);
  }
  /// Takes the earliest signal and returns when it arrives; std::nullopt when none is known.
  std::optional<Cycles> take(int semaphore) { return file_.take(semaphore); }
  const SemaphoreFile& file() const { return file_; }

  WaitRecord& record() { return record_; }
  const std::vector<std::string>& names() const { return names_; }
  /// What a blocked wait for the semaphore counts as.
  CycleCause cause_of_wait(int semaphore) const;
  /// The wait graph at `now` (WaitRecord::deadlock).
  std::string deadlock(Cycles now) const { return record_.deadlock(now, file_, names_); }

 private:
  const std::vector<std::string>& names_;
  SemaphoreFile file_;
  WaitRecord record_;
};

}  // namespace model
