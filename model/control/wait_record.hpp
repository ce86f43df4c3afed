#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "firmware/cn/chip/transfer.hpp"
#include "firmware/cn/machine.hpp"
#include "model/control/semaphore_file.hpp"
#include "model/time/cycles.hpp"

namespace model {

/// Who can wait for a semaphore.
enum class Waiter : std::uint8_t { control_unit, host };
inline constexpr int kWaiters = 2;

/// Who can signal one.
enum class Signaller : std::uint8_t { control_unit, host, pio };

/// Who waits for each semaphore, who signalled it last, who shares it and which transfers were started on it:
/// kept to say what a wait is for, and for the report of a deadlock. Costs a few stores an event.
class WaitRecord {
 public:
  void waits(Waiter waiter, cn::Semaphore semaphore, Cycles since);
  void goes_on(Waiter waiter, Cycles at);
  void signalled(int semaphore, Signaller by, Cycles at) { last_signal_[std::size_t(semaphore)] = {by, at}; }
  void started(const cn::Transfer& transfer, Cycles at);
  void ran_kernel(const char* name, Cycles at) {
    last_kernel_ = name;
    last_kernel_cycle_ = at;
  }
  /// Forgets all but who shares what.
  void clear();
  /// From now on the host is one of those who may signal or wait.
  void share_with_host(cn::Semaphore semaphore) { shared_with_host_.at(std::size_t(semaphore.index)) = true; }

  bool is_shared_with_host(int semaphore) const { return shared_with_host_[std::size_t(semaphore)]; }
  /// Direction of the latest transfer that signals `semaphore`; mono to poly before the first.
  cn::Direction latest_transfer(int semaphore) const { return started_[std::size_t(semaphore)].direction; }

  /// The wait graph of a chip on which nobody can go on: a summarising line, then one line for each waiter,
  /// with the semaphore's count, who can signal it and who did last; then the signals that nobody has taken.
  /// No newline at the end.
  /// @param names of the semaphores that the firmware has allocated
  std::string deadlock(Cycles now, const SemaphoreFile& semaphores,
                       const std::vector<std::string>& names) const;

 private:
  struct Wait {
    std::optional<int> semaphore;  ///< the one waited for now
    Cycles since = 0;
    std::optional<int> taken;  ///< the one waited for last
    Cycles taken_at = 0;
  };
  struct Signal {
    Signaller by;
    Cycles at;
  };
  struct Started {
    std::uint64_t count = 0;
    cn::Direction direction = cn::Direction::mono_to_poly;  ///< direction of the last
    Cycles at = 0;
  };

  bool has_host() const;
  std::string summary(Cycles now, const std::vector<std::string>& names) const;
  std::string waiter_line(Waiter waiter, const SemaphoreFile& semaphores,
                          const std::vector<std::string>& names) const;
  std::string candidates(Waiter waiter, int semaphore) const;
  std::string history(int semaphore) const;
  std::string unclaimed_line(const SemaphoreFile& semaphores, const std::vector<std::string>& names) const;

  std::array<Wait, kWaiters> waits_;
  std::array<std::optional<Signal>, cn::Machine::kSemaphores> last_signal_{};
  std::array<Started, cn::Machine::kSemaphores> started_{};
  std::array<bool, cn::Machine::kSemaphores> shared_with_host_{};
  const char* last_kernel_ = nullptr;
  Cycles last_kernel_cycle_ = 0;
};

}  // namespace model
