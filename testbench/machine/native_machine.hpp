#pragma once

#include <array>
#include <functional>
#include <vector>

#include "firmware/cn/chip/search_buffer.hpp"
#include "firmware/cn/machine.hpp"
#include "testbench/machine/native_threads.hpp"

namespace testbench {

/// cn::Machine without a clock: transfers are instant and instructions take no time. It is the functional
/// reference of the tests and serves fast previews. A thread runs until it waits for a semaphore without a
/// signal.
class NativeMachine : public cn::Machine {
 public:
  /// @param scratchpad where memory beside the first `mono_bytes` lies, if there is any
  /// @param search_unit where the buffer of a search unit lies, if there is one
  NativeMachine(int num_pes, int poly_bytes_per_pe, std::uint64_t mono_bytes, cn::MonoRange scratchpad = {},
                cn::MonoRange search_unit = {});

  std::uint8_t* mono() { return mono_.data(); }
  std::uint64_t mono_bytes() const { return mono_.size(); }
  std::uint8_t* scratchpad_bytes() { return scratchpad_bytes_.data(); }
  cn::MonoRange scratchpad() const override { return scratchpad_; }
  cn::MonoRange search_unit() const override { return search_unit_; }
  void program_search_unit(std::shared_ptr<cn::SearchFunction> function) override;

  /// Sets the host's reaction to a signal of `semaphore`: `service` runs at once, on the firmware's thread,
  /// instead of counting the signal.
  void on_signal(cn::Semaphore semaphore, std::function<void()> service);

  /// Runs firmware until all its threads have ended. Firmware with a single thread may also be called
  /// directly.
  void run_firmware(const std::function<void(cn::Machine&)>& firmware);

  /// Kernels may leave out what only charges instructions, from now on. The results are the same.
  void stop_counting() { counts_instructions_ = false; }
  bool counts_instructions() const override { return counts_instructions_; }

  void start_thread(int priority, const std::string& name, std::function<void()> body) override;
  void sem_signal(cn::Semaphore semaphore) override;
  void sem_wait(cn::Semaphore semaphore) override;
  void issue_mono(std::uint64_t) override {}
  void timed(bool on) override;

 protected:
  void retire(const char*, const cn::IssueTree&) override {}
  void start_transfer(const cn::Transfer& transfer) override;
  const void* read_mono_bytes(cn::MonoAddress from, std::size_t bytes) override;
  void write_mono_bytes(cn::MonoAddress to, const void* bytes, std::size_t size) override;

 private:
  /// Where these bytes are; null outside memory.
  std::uint8_t* find(cn::MonoAddress first, std::uint64_t bytes);
  /// Throws cn::MachineFault outside memory.
  std::uint8_t* storage(cn::MonoAddress first, std::uint64_t bytes, const char* what);
  bool move_within(const cn::Transfer& transfer, const cn::MonoRange& range, std::uint8_t* bytes);
  /// The same for the search unit's buffer.
  bool move_queries(const cn::Transfer& transfer);

  bool counts_instructions_ = true;
  std::vector<std::uint8_t> mono_;
  cn::MonoRange scratchpad_;
  std::vector<std::uint8_t> scratchpad_bytes_;
  cn::MonoRange search_unit_;
  cn::SearchBuffer search_buffer_;
  std::array<int, kSemaphores> semaphores_{};
  std::array<std::function<void()>, kSemaphores> services_;
  NativeThreads threads_;
};

}  // namespace testbench
