#pragma once

#include <array>
#include <functional>
#include <list>
#include <optional>
#include <string>
#include <vector>

#include "firmware/cn/chip/access_observer.hpp"
#include "firmware/cn/machine.hpp"
#include "model/hazards/mono_footprint.hpp"
#include "model/hazards/poly_occupancy.hpp"
#include "model/time/cycles.hpp"

namespace model {

/// Finds firmware that uses what a transfer may still be reading or writing. n-buffering
/// (paper, section 3.3) is explicit, so it can be got wrong, and a model in which data happen to be there
/// in time would not show it.
///
/// A transfer is outstanding from its start until the firmware knows that it is over: until its semaphore was
/// waited for, however early it finished in simulated time. A wait tells this much: the engine finishes the
/// transfers of one direction in the order in which they were started, under every arbitration (PioQueue);
/// nothing else is certain. So a transfer is over once its semaphore has been waited for more often than it
/// can have been signalled before this transfer: by transfers of its own direction started earlier, and by
/// any transfer of the other direction, any transfer without data (it signals at once) and any signal of the
/// firmware or the host.
///
/// While a transfer is outstanding nobody else may write what it reads, or read or write what it writes: not
/// kernels (on PEs that are enabled), other transfers, the control unit, nor the host. Addresses that PEs
/// hold in poly memory belong to what it reads, as the engine asks the PEs one after the other (US
/// 7,363,472).
///
/// An access of a kernel outside the PEs' SRAM is found, too, whatever it does to the simulator afterwards.
///
/// Untimed work sees all data at once by design and is not judged. A save may overwrite what untimed work has
/// seen of an earlier save before that one was waited for: saves land in their order. What a kernel reads of
/// mono memory is judged where the control unit asks for it (Machine::read_mono).
class HazardChecker : public cn::AccessObserver {
 public:
  /// The machine's cycle; empty for a machine without a clock.
  using Clock = std::function<Cycles()>;

  explicit HazardChecker(const cn::Machine& machine, Clock clock = {});

  /// A name for these bytes of mono memory, for messages.
  void name_mono(const std::string& name, const MonoRange& range) { mono_names_.push_back({name, range}); }

  /// Throws the first hazard, or one if a transfer was never waited for: nobody knows that its data are
  /// there.
  void firmware_ends();
  /// The host reads or writes mono memory on a signal of the firmware. Does not throw, so that the host need
  /// not be able to stop: the next event of the firmware does, or throw_if_found().
  void host_touches_mono(cn::Access access, const MonoRange& range) noexcept;
  void throw_if_found() const;
  /// The first hazard; empty when there is none so far.
  const std::string& hazard() const { return hazard_; }

  std::size_t outstanding() const { return outstanding_.size(); }
  /// Transfers with data so far.
  std::uint64_t requests() const { return next_id_; }

  // These throw cn::MachineFault, one line, except touches_poly(), waited() and signalled(), which a kernel
  // or the host may be in the midst of.
  void kernel_begins(const char* kernel) override;
  void touches_poly(cn::Access access, cn::PolySpan bytes, int first_pe,
                    std::uint32_t enabled) noexcept override;
  void kernel_is_silent() noexcept override;
  void kernel_ends() override { throw_if_found(); }
  void touches_mono(cn::Access access, cn::MonoAddress first, std::size_t bytes) override;
  void transfer_starts(const cn::Transfer& transfer) override;
  void waited(cn::Semaphore semaphore) override;
  void signalled(cn::Semaphore semaphore) override;
  void timed(bool on) override;

 private:
  struct PolyUse {
    cn::Access access = cn::Access::read;
    cn::PolySpan span;
    bool is_addresses = false;
  };
  struct Request {
    std::uint64_t id = 0;  ///< as the PIO engine numbers it: transfers with data, by start
    cn::Direction direction = cn::Direction::mono_to_poly;
    cn::PolySpan span;
    std::optional<cn::PolySpan> addresses;
    cn::LaneMask pes;
    cn::Semaphore done;
    Cycles started = 0;
    std::uint64_t of_direction = 0;  ///< transfers of its direction and semaphore started before it
    MonoFootprint mono;
    bool seen_by_untimed_work = false;

    std::vector<PolyUse> poly_uses() const;
    cn::Access mono_access() const {
      return direction == cn::Direction::mono_to_poly ? cn::Access::read : cn::Access::write;
    }
  };
  struct Signals {
    std::array<std::uint64_t, 2> transfers{};  ///< started with data, by direction
    std::uint64_t others = 0;
    std::uint64_t waits = 0;
  };
  struct MonoName {
    std::string name;
    MonoRange range;
  };

  int sram_bytes() const;  ///< of a PE
  bool is_in_sram(cn::PolySpan bytes) const;
  bool is_over(const Request& request) const;
  void release_if_over(cn::Semaphore semaphore);
  std::optional<cn::PolySpan> poly_addresses(const cn::MonoPlaces& places) const;

  void check_poly(const Request& request);
  void check_mono(const Request& request);
  void check_mono(const MonoFootprint& footprint, cn::Access access, const std::string& who);
  void found_in_mono(const std::string& who, cn::Access access, const MonoRange& shared,
                     const Request& holder);
  void found_in_poly(const std::string& who, cn::Access access, cn::PolySpan bytes,
                     const PolyOccupancy::Conflict& conflict);

  std::string opening(bool within_kernel) const;
  std::string describe(const Request& request, bool with_start) const;
  std::string mono_name(const MonoRange& range) const;
  std::string poly_name(cn::PolySpan bytes) const;

  const cn::Machine& machine_;
  Clock clock_;
  std::vector<MonoName> mono_names_;
  PolyOccupancy occupancy_;
  std::list<Request> outstanding_;
  std::vector<Signals> signals_;
  std::uint64_t next_id_ = 0;
  bool timed_ = true;
  std::string kernel_;  ///< the latest
  std::string hazard_;  ///< the first; empty when there is none
};

}  // namespace model
