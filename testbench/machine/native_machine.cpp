#include "testbench/machine/native_machine.hpp"

#include <cstring>

namespace testbench {

NativeMachine::NativeMachine(int num_pes, int poly_bytes_per_pe, std::uint64_t mono_bytes,
                             cn::MonoRange scratchpad, cn::MonoRange search_unit)
    : Machine(num_pes, poly_bytes_per_pe),
      mono_(mono_bytes),
      scratchpad_(scratchpad),
      scratchpad_bytes_(scratchpad.bytes),
      search_unit_(search_unit),
      search_buffer_(search_unit),
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
  if (!move_within(transfer, {0, mono_.size()}, mono_.data()) &&
      !move_within(transfer, scratchpad_, scratchpad_bytes_.data()) && !move_queries(transfer)) {
    const int outside = cn::first_pe_not(
        transfer, num_pes(), [&](cn::MonoAddress place) { return find(place, bytes) != nullptr; });
    if (outside >= 0) storage(transfer.mono[outside], bytes, "transfer");
    for (int pe = 0; pe < num_pes(); ++pe) {
      if (!transfer.enabled[pe]) continue;
      cn::Transfer one_pe = transfer;
      one_pe.enabled = cn::LaneMask();
      one_pe.enabled.set(pe, true);
      one_pe.mono = cn::MonoPlaces::array(0, 0);
      cn::move_data(one_pe, poly_memory(), find(transfer.mono[pe], bytes));
    }
  }
  ++semaphores_.at(std::size_t(transfer.done.index));
}

/// Whether all places lie in `range`; the data have moved then.
bool NativeMachine::move_within(const cn::Transfer& transfer, const cn::MonoRange& range,
                                std::uint8_t* bytes) {
  if (!cn::lies_within(transfer, num_pes(), range)) return false;
  cn::Transfer from_start = transfer;
  from_start.mono.first -= range.first;
  cn::move_data(from_start, poly_memory(), bytes);
  return true;
}

void NativeMachine::program_search_unit(std::shared_ptr<cn::SearchFunction> function) {
  if (search_unit_.bytes == 0) return Machine::program_search_unit(std::move(function));
  search_buffer_.program(std::move(function));
}

bool NativeMachine::move_queries(const cn::Transfer& transfer) {
  if (search_unit_.bytes == 0 || !cn::lies_within(transfer, num_pes(), search_unit_)) return false;
  const auto read_memory = [this](cn::MonoAddress from, void* to, std::size_t bytes) {
    std::memcpy(to, storage(from, bytes, "search unit's read"), bytes);
  };
  const auto bytes = std::size_t(transfer.poly.size_bytes);
  std::vector<std::uint8_t> piece(bytes);
  for (int pe = 0; pe < num_pes(); ++pe) {
    if (!transfer.enabled[pe]) continue;
    const std::uint64_t address = transfer.mono[pe] - search_unit_.first;
    cn::Transfer one_pe = transfer;
    one_pe.enabled = cn::LaneMask();
    one_pe.enabled.set(pe, true);
    one_pe.mono = cn::MonoPlaces::array(0, 0);
    const bool loads = transfer.direction == cn::Direction::mono_to_poly;
    if (loads) search_buffer_.read(address, piece.data(), bytes, read_memory);
    cn::move_data(one_pe, poly_memory(), piece.data());
    if (!loads) search_buffer_.write(address, piece.data(), bytes);
  }
  return true;
}

const void* NativeMachine::read_mono_bytes(cn::MonoAddress from, std::size_t bytes) {
  return storage(from, bytes, "mono read");
}

void NativeMachine::write_mono_bytes(cn::MonoAddress to, const void* bytes, std::size_t size) {
  std::memcpy(storage(to, size, "mono write"), bytes, size);
}

std::uint8_t* NativeMachine::find(cn::MonoAddress first, std::uint64_t bytes) {
  if (cn::MonoRange{0, mono_.size()}.contains(first, bytes)) return mono_.data() + first;
  if (scratchpad_.contains(first, bytes)) return scratchpad_bytes_.data() + (first - scratchpad_.first);
  return nullptr;
}

std::uint8_t* NativeMachine::storage(cn::MonoAddress first, std::uint64_t bytes, const char* what) {
  if (std::uint8_t* const found = find(first, bytes)) return found;
  const std::string beside = scratchpad_.bytes == 0
                                 ? ""
                                 : " and a scratchpad of " + std::to_string(scratchpad_.bytes) +
                                       " bytes at " + std::to_string(scratchpad_.first);
  throw cn::MachineFault(std::string(what) + " of " + std::to_string(bytes) + " bytes at " +
                         std::to_string(first) + " leaves mono memory of " + std::to_string(mono_.size()) +
                         " bytes" + beside);
}

}  // namespace testbench
