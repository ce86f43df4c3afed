#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/cn/chip/mono_memory.hpp"
#include "firmware/cn/chip/poly_memory.hpp"

namespace cn {

struct Semaphore;
struct Transfer;

enum class Access : std::uint8_t { read, write };

/// Is told who touches what data and which synchronisation lies between, in the order of the firmware.
/// Observing costs no cycle and changes nothing. Kernels report their SRAM accesses if they are built to
/// (kObservedSram, strip.hpp).
class AccessObserver {
 public:
  virtual ~AccessObserver() = default;

  virtual void kernel_begins(const char* kernel) = 0;
  /// PEs first_pe + i, for every bit i of `enabled`, touch these bytes of their SRAM. Called from within
  /// kernels, which an exception must not leave: kernel_ends() throws what is to stop the run.
  virtual void touches_poly(Access access, PolySpan bytes, int first_pe, std::uint32_t enabled) noexcept = 0;
  /// The running kernel is not built to report what it touches.
  virtual void kernel_is_silent() noexcept = 0;
  virtual void kernel_ends() = 0;

  /// The control unit touches mono memory.
  virtual void touches_mono(Access access, MonoAddress first, std::size_t bytes) = 0;

  virtual void transfer_starts(const Transfer& transfer) = 0;
  /// A wait on the semaphore took one of its signals.
  virtual void waited(Semaphore semaphore) = 0;
  /// A signal by the firmware itself or by the host, not by a transfer.
  virtual void signalled(Semaphore semaphore) = 0;
  /// See Machine::timed().
  virtual void timed(bool on) = 0;
};

}  // namespace cn
