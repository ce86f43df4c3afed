#include "testbench/machine/native_machine.hpp"

#include <cstring>

namespace testbench {

NativeMachine::NativeMachine(int num_pes, int poly_bytes_per_pe, std::uint64_t mono_bytes)
    : Machine(num_pes, poly_bytes_per_pe),
      mono_(mono_bytes),
      threads_(*this, [this](int semaphore) { return semaphores_.at(std::size_t(semaphore)) > 0; }) {}

void NativeMachine::run_firmware(const std::function<void(cn::Machine&)>& firmware) {
  threads_.run([&] { firmware(*this); });
}

void NativeMachine::start_thread(int priority, const std::string& name, std::function<void()> body) {
  threads_.start(priority, name, std::move(body));
}

void NativeMachine::on_signal(cn::Semaphore semaphore, std::function<void()> service) {
  services_.at(std::size_t(semaphore.index)) = std::move(service);
}

void NativeMachine::sem_signal(cn::Semaphore semaphore) {
  if (const auto& service = services_.at(std::size_t(semaphore.index))) {
    service();
  } else {
    ++semaphores_[std::size_t(semaphore.index)];
    if (access_observer() != nullptr) access_observer()->signalled(semaphore);
  }
}

void NativeMachine::timed(bool on) {
  if (access_observer() != nullptr) access_observer()->timed(on);
}

void NativeMachine::sem_wait(cn::Semaphore semaphore) {
  int& count = semaphores_.at(std::size_t(semaphore.index));
  if (count == 0 && !threads_.wait(semaphore.index))
    throw cn::MachineFault("wait on semaphore '" + semaphore_name(semaphore) + "' that nothing will signal");
  --count;
  if (access_observer() != nullptr) access_observer()->waited(semaphore);
}

void NativeMachine::start_transfer(const cn::Transfer& transfer) {
  const auto bytes = std::uint64_t(transfer.poly.size_bytes);
  const int outside =
      cn::first_pe_not(transfer, num_pes(), [&](cn::MonoAddress place) { return is_within(place, bytes); });
  if (outside >= 0) check_range(transfer.mono[outside], bytes, "transfer");
  cn::move_data(transfer, poly_memory(), mono_.data());
  ++semaphores_.at(std::size_t(transfer.done.index));
}

const void* NativeMachine::read_mono_bytes(cn::MonoAddress from, std::size_t bytes) {
  check_range(from, bytes, "mono read");
  return mono_.data() + from;
}

void NativeMachine::write_mono_bytes(cn::MonoAddress to, const void* bytes, std::size_t size) {
  check_range(to, size, "mono write");
  std::memcpy(mono_.data() + to, bytes, size);
}

void NativeMachine::check_range(cn::MonoAddress first, std::uint64_t bytes, const char* what) const {
  if (!is_within(first, bytes))
    throw cn::MachineFault(std::string(what) + " of " + std::to_string(bytes) + " bytes at " +
                           std::to_string(first) + " leaves mono memory of " + std::to_string(mono_.size()) +
                           " bytes");
}

}  // namespace testbench
