#include "testbench/machine/recording_machine.hpp"

#include <utility>

namespace testbench {

RecordingMachine::RecordingMachine(int num_pes, int poly_bytes_per_pe, std::uint64_t mono_bytes,
                                   TimingStream& stream, cn::MonoRange scratchpad)
    : NativeMachine(num_pes, poly_bytes_per_pe, mono_bytes, scratchpad), stream_(stream), writer_(stream) {
  stream_.num_pes = num_pes;
}

void RecordingMachine::finish() {
  stream_.semaphores = semaphore_names();
  for (const cn::PolyMemory::Buffer& buffer : poly_memory().buffers())
    stream_.poly_buffers.push_back({buffer.name, buffer.span.size_bytes});
}

void RecordingMachine::start_thread(int, const std::string& name, std::function<void()>) {
  throw cn::MachineFault("start of thread '" + name + "': a recorded stream has one thread");
}

void RecordingMachine::timed(bool on) {
  timed_ = on;
  NativeMachine::timed(on);
}

void RecordingMachine::sem_signal(cn::Semaphore semaphore) {
  if (timed_ && !host_answers_) writer_.signal(semaphore);
  const bool host_answered =
      std::exchange(host_answers_, true);  // signals that the host sends are not part of the stream
  NativeMachine::sem_signal(semaphore);
  host_answers_ = host_answered;
}

void RecordingMachine::sem_wait(cn::Semaphore semaphore) {
  if (timed_) writer_.wait(semaphore);
  NativeMachine::sem_wait(semaphore);
}

void RecordingMachine::issue_mono(std::uint64_t instructions) {
  if (timed_) writer_.mono(instructions);
}

void RecordingMachine::retire(const char* kernel, const cn::IssueTree& issued) {
  if (timed_ && issued.root().reached) writer_.kernel(kernel, issued);
}

void RecordingMachine::start_transfer(const cn::Transfer& transfer) {
  if (timed_) writer_.transfer(transfer);
  NativeMachine::start_transfer(transfer);
}

const void* RecordingMachine::read_mono_bytes(cn::MonoAddress from, std::size_t bytes) {
  if (timed_) writer_.read(from, bytes);
  return NativeMachine::read_mono_bytes(from, bytes);
}

void RecordingMachine::write_mono_bytes(cn::MonoAddress to, const void* bytes, std::size_t size) {
  if (timed_) writer_.write(to, bytes, size);
  NativeMachine::write_mono_bytes(to, bytes, size);
}

}  // namespace testbench
