#pragma once

#include "testbench/machine/native_machine.hpp"
#include "testbench/machine/timing_stream.hpp"

namespace testbench {

/// A native machine that records the calls of its firmware. The firmware runs once, as fast as native code;
/// the recorded stream can then be replayed on any number of chips.
class RecordingMachine : public NativeMachine {
 public:
  /// @param stream must be empty; filled while the firmware runs and completed by finish()
  RecordingMachine(int num_pes, int poly_bytes_per_pe, std::uint64_t mono_bytes, TimingStream& stream,
                   cn::MonoRange scratchpad = {});

  /// Must be called when the firmware has ended.
  void finish();

  /// Throws cn::MachineFault, because a stream has only one thread.
  void start_thread(int priority, const std::string& name, std::function<void()> body) override;
  void sem_signal(cn::Semaphore semaphore) override;
  void sem_wait(cn::Semaphore semaphore) override;
  void issue_mono(std::uint64_t instructions) override;
  void timed(bool on) override;

 protected:
  void retire(const char* kernel, const cn::IssueTree& issued) override;
  void start_transfer(const cn::Transfer& transfer) override;
  const void* read_mono_bytes(cn::MonoAddress from, std::size_t bytes) override;
  void write_mono_bytes(cn::MonoAddress to, const void* bytes, std::size_t size) override;

 private:
  TimingStream& stream_;
  TimingStreamWriter writer_;
  bool timed_ = true;
  bool host_answers_ = false;
};

}  // namespace testbench
