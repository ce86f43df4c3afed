#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/cn/chip/label.hpp"
#include "firmware/cn/chip/mono_range.hpp"
#include "firmware/cn/chip/search_unit.hpp"
#include "firmware/cn/chip/transfer.hpp"
#include "firmware/cn/language/kernel.hpp"

namespace cn {

/// A firmware fault: unaligned transfer, address outside mono memory, no semaphore left, a wait that can
/// never end.
class MachineFault : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Priority of the initial thread. Other threads may have higher, lower or equal priority.
inline constexpr int kFirstThreadPriority = 0;

/// The chip as firmware sees it: one control unit with its mono memory, a PE array with its poly memory, and
/// the programmed I/O between them. Implementations decide what an operation costs and when a transfer is
/// over.
class Machine {
 public:
  static constexpr int kSemaphores = 64;

  /// @param num_pes a multiple of kStripLanes, at most kMaxPes
  Machine(int num_pes, int poly_bytes_per_pe);
  virtual ~Machine() = default;
  Machine(const Machine&) = delete;
  Machine& operator=(const Machine&) = delete;

  int num_pes() const { return poly_memory_.num_pes(); }
  /// Whether anything depends on which instructions kernels issue. If not, the simulator may leave out what
  /// only charges.
  virtual bool counts_instructions() const { return true; }
  PolyMemory& poly_memory() { return poly_memory_; }
  const PolyMemory& poly_memory() const { return poly_memory_; }

  /// Runs a kernel on the enabled PEs and charges what it issued.
  template <class Arguments>
  void run(const Kernel<Arguments>& kernel, const Arguments& arguments, const LaneMask& enabled) {
    if (access_observer() != nullptr) access_observer()->kernel_begins(kernel.name);
    kernel.run(arguments, poly_memory_, enabled, issued_);
    if (access_observer() != nullptr) access_observer()->kernel_ends();
    kernel_lanes_ = &enabled;
    retire(kernel.name, issued_);
    kernel_lanes_ = nullptr;
  }

  /// Asynchronous copies between mono and poly memory; the PE array continues to compute. Only enabled PEs
  /// take part. A transfer without an enabled PE still signals `done`. Each PE's address and the size are
  /// multiples of 8 bytes.
  void async_copy_m2p(Semaphore done, PolySpan destination, const MonoPlaces& source,
                      const LaneMask& enabled);
  void async_copy_p2m(Semaphore done, const MonoPlaces& destination, PolySpan source,
                      const LaneMask& enabled);

  /// The addresses that PEs hold in a poly variable, plus a mono offset, for a gather or scatter.
  MonoPlaces places_in(PolyField<MonoAddress> addresses, std::uint64_t offset_bytes = 0) {
    return MonoPlaces::each(poly_memory_.strip(0, addresses.offset_bytes), offset_bytes,
                            poly_memory_.strip_words());
  }

  /// Allocates a semaphore; `name` appears in waves and fault messages.
  Semaphore allocate_semaphore(const std::string& name);
  const std::vector<std::string>& semaphore_names() const { return semaphore_names_; }
  const std::string& semaphore_name(Semaphore semaphore) const {
    return semaphore_names_.at(std::size_t(semaphore.index));
  }

  virtual void sem_signal(Semaphore semaphore) = 0;
  virtual void sem_wait(Semaphore semaphore) = 0;

  /// Starts a hardware thread that runs `body`. The control unit has one instruction stream. A thread keeps
  /// it until it waits on a semaphore that is not signalled; then the ready thread of the highest priority
  /// runs, among equals the one that was started first. Greater numbers are higher; the initial thread has
  /// kFirstThreadPriority. A thread of higher priority than the running one takes over as soon as it is
  /// ready, between two kernels, batches of mono instructions, requests or semaphore operations. A new thread
  /// may do so within this call, which itself takes no time.
  ///
  /// The run is over when all threads are. To wait for one, let the end of its `body` signal a semaphore.
  /// What `body` refers to must live as long as it runs. Threads do not change within Untimed.
  ///
  /// Throws MachineFault when the machine has no thread left (csx600: control.threads).
  virtual void start_thread(int priority, const std::string& name, std::function<void()> body);

  /// Returns how many PEs hold true: a reduction that the control unit reads, with its cost.
  int count(const LaneMask& lanes);

  /// Gives the PEs of `chosen` ascending numbers 0, 1, 2, ... from left to right, over the PE-to-PE path
  /// (paper, section 4). Returns how many there are. Used as addresses, the numbers compact what the chosen
  /// PEs save.
  int number_ascending(const LaneMask& chosen, PolyField<std::int32_t> number);

  /// The same for several things in each PE, of which `chosen[0]` to `chosen[things - 1]` choose some: each
  /// PE's `number` becomes the first of its own, and the others follow.
  int number_ascending(const LaneMask* chosen, int things, PolyField<std::int32_t> number);

  /// Each PE takes the `value` of its left neighbour (up) or right neighbour (down). The PE at the end of the
  /// path keeps its own.
  void swazzle_up(PolyField<std::uint64_t> value);
  void swazzle_down(PolyField<std::uint64_t> value);

  /// Issues instructions of the control unit outside kernels: loop control, address arithmetic, request
  /// set-up.
  virtual void issue_mono(std::uint64_t instructions) = 0;

  /// Mono memory as the control unit reads it, through its data cache; valid until the run ends.
  template <class T>
  const T* read_mono(MonoPointer<T> from, std::size_t count = 1) {
    observe_mono(Access::read, from.address, count * sizeof(T));
    return static_cast<const T*>(read_mono_bytes(from.address, count * sizeof(T)));
  }
  template <class T>
  void write_mono(MonoPointer<T> to, const T& value) {
    observe_mono(Access::write, to.address, sizeof(T));
    write_mono_bytes(to.address, &value, sizeof(T));
  }

  /// The mono addresses of the memory on the chip, for data that are used often: all transfers reach it as
  /// they reach the rest of mono memory, sooner and beside it. No bytes if the machine has none.
  virtual MonoRange scratchpad() const { return {}; }

  /// The mono addresses of the search unit's buffer (search_places()). Transfers write queries there; one
  /// that reads answers takes until they are found. No bytes if the machine has no such unit.
  virtual MonoRange search_unit() const { return {}; }
  /// Tells the search unit what to do with the queries that follow. Throws MachineFault if there is none.
  virtual void program_search_unit(std::shared_ptr<SearchFunction> function);

  /// Labels the kernels and requests that follow.
  void set_label(const Label& label) { label_ = label; }
  /// Tells observers which PEs' slots of a block of the bins hold work from now on.
  virtual void report_fill(int /*block*/, const LaneMask& /*slots*/) {}

  /// Until timed(true), work takes no time: it stands for what a timed program leaves to others. Such work
  /// sees the data of every transfer started before it, waited for or not, and does not use up their signals.
  virtual void timed(bool on) = 0;

  /// Sets who is told of accesses and synchronisation from now on; may be null.
  void set_access_observer(AccessObserver* observer) { poly_memory_.set_observer(observer); }

 protected:
  /// The observer, which implementations tell of waits, signals and timed(); null when there is none.
  AccessObserver* access_observer() const { return poly_memory_.observer(); }
  const Label& label() const { return label_; }
  /// The PEs enabled for the kernel that retires; null for an operation of all PEs.
  const LaneMask* kernel_lanes() const { return kernel_lanes_; }

  /// Frees poly buffers and semaphores: another program begins.
  void begin_program();

  virtual void retire(const char* kernel, const IssueTree& issued) = 0;
  virtual void start_transfer(const Transfer& transfer) = 0;
  virtual const void* read_mono_bytes(MonoAddress from, std::size_t bytes) = 0;
  virtual void write_mono_bytes(MonoAddress to, const void* bytes, std::size_t size) = 0;

 private:
  void observe_mono(Access access, MonoAddress first, std::size_t bytes) {
    if (access_observer() != nullptr) access_observer()->touches_mono(access, first, bytes);
  }
  void observe_poly(Access access, PolySpan bytes, const LaneMask& enabled);
  void begin_transfer(const Transfer& transfer);
  void charge_running_count();
  int write_ascending(const LaneMask& chosen, PolyField<std::int32_t> number);
  void observe_swazzle(const char* name, PolyField<std::uint64_t> value, int from_neighbour);
  void swazzle_rows(PolyField<std::uint64_t> value, int from_neighbour);

  PolyMemory poly_memory_;
  IssueTree issued_;
  Label label_;
  const LaneMask* kernel_lanes_ = nullptr;
  std::vector<std::string> semaphore_names_;
};

/// Work within the scope takes no time and is not counted.
class Untimed {
 public:
  explicit Untimed(Machine& machine) : machine_(machine) { machine_.timed(false); }
  ~Untimed() { machine_.timed(true); }
  Untimed(const Untimed&) = delete;
  Untimed& operator=(const Untimed&) = delete;

 private:
  Machine& machine_;
};

}  // namespace cn
