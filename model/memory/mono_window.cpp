#include "model/memory/mono_window.hpp"

#include <cinttypes>
#include <cstdio>
#include <cstring>

#include "firmware/cn/language/offset_bits.hpp"
#include "firmware/cn/machine.hpp"
#include "model/transaction/payload.hpp"

namespace model {
namespace {

std::string hexadecimal(std::uint64_t value) {
  char digits[2 + 16 + 1];
  std::snprintf(digits, sizeof(digits), "0x%" PRIx64, value);
  return digits;
}

std::string name_of(const cn::Transfer& transfer, std::uint64_t request) {
  return "PIO request " + std::to_string(request) + " (" +
         (transfer.direction == cn::Direction::mono_to_poly ? "mono to poly" : "poly to mono") +
         ", semaphore " + std::to_string(transfer.done.index) + "): ";
}

}  // namespace

MonoWindow::MonoWindow(std::uint64_t size_bytes, cn::PolyMemory& poly)
    : size_bytes_(size_bytes),
      poly_(poly),
      piece_(std::size_t(poly.capacity_bytes() + cn::PolyMemory::kReservedBytes)) {}

void MonoWindow::check_span(const cn::Transfer& transfer, std::uint64_t request) const {
  const auto sram_bytes = static_cast<int>(piece_.size());
  const cn::PolySpan& poly = transfer.poly;
  if (poly.size_bytes < 0 || poly.size_bytes > sram_bytes || poly.offset_bytes < 0 ||
      poly.offset_bytes > sram_bytes - poly.size_bytes)
    throw cn::MachineFault(name_of(transfer, request) + std::to_string(poly.size_bytes) +
                           " bytes at poly offset " + std::to_string(poly.offset_bytes) +
                           ", a PE's SRAM is 0 to " + std::to_string(sram_bytes - 1));
}

void MonoWindow::check_places(const cn::Transfer& transfer, std::uint64_t request) const {
  const auto bytes = std::uint64_t(transfer.poly.size_bytes);
  if (transfer.mono.by_pe != nullptr && bytes <= size_bytes_) {
    const std::uint64_t highest = cn::offset_bits(transfer.mono, poly_.num_pes());
    if (transfer.mono.first <= size_bytes_ - bytes && highest <= size_bytes_ - bytes - transfer.mono.first)
      return;
  }
  const int pe = cn::first_pe_not(transfer, poly_.num_pes(), [&](cn::MonoAddress address) {
    return address <= size_bytes_ && bytes <= size_bytes_ - address;
  });
  if (pe < 0) return;
  throw cn::MachineFault(name_of(transfer, request) + "PE " + std::to_string(pe) + " addresses " +
                         std::to_string(bytes) + " bytes at " + hexadecimal(transfer.mono[pe]) +
                         ", mono memory is 0x0 to " + hexadecimal(size_bytes_ - 1));
}

void MonoWindow::move(const cn::Transfer& transfer, tlm::tlm_fw_transport_if<>& memory) {
  if (has_pointer(memory)) {
    cn::move_data(transfer, poly_, mono_);
  } else {
    move_by_debug(transfer, memory);
  }
}

bool MonoWindow::has_pointer(tlm::tlm_fw_transport_if<>& memory) {
  if (pointer_ == Pointer::not_asked) {
    tlm::tlm_generic_payload transaction;
    transaction.set_write();
    transaction.set_address(0);
    tlm::tlm_dmi dmi;
    const bool granted = memory.get_direct_mem_ptr(transaction, dmi) && dmi.is_read_write_allowed() &&
                         dmi.get_start_address() == 0 && dmi.get_end_address() >= size_bytes_ - 1;
    pointer_ = granted ? Pointer::granted : Pointer::refused;
    mono_ = granted ? dmi.get_dmi_ptr() : nullptr;
  }
  return pointer_ == Pointer::granted;
}

void MonoWindow::move_by_debug(const cn::Transfer& transfer, tlm::tlm_fw_transport_if<>& memory) {
  const bool to_poly = transfer.direction == cn::Direction::mono_to_poly;
  const auto bytes = std::uint64_t(transfer.poly.size_bytes);
  cn::Transfer one_pe = transfer;
  one_pe.mono = cn::MonoPlaces::array(0, 0);  // piece_ stands for mono memory
  for (int pe = 0; pe < poly_.num_pes(); ++pe) {
    if (!transfer.enabled[pe]) continue;
    one_pe.enabled = cn::LaneMask();
    one_pe.enabled.set(pe, true);
    if (to_poly) debug(tlm::TLM_READ_COMMAND, transfer.mono[pe], piece_.data(), bytes, memory);
    cn::move_data(one_pe, poly_, piece_.data());
    if (!to_poly) debug(tlm::TLM_WRITE_COMMAND, transfer.mono[pe], piece_.data(), bytes, memory);
  }
}

void MonoWindow::read(cn::MonoAddress address, std::uint8_t* to, std::uint64_t bytes,
                      tlm::tlm_fw_transport_if<>& memory) {
  if (has_pointer(memory)) {
    std::memcpy(to, mono_ + address, bytes);
  } else {
    debug(tlm::TLM_READ_COMMAND, address, to, bytes, memory);
  }
}

void MonoWindow::check_range(cn::MonoAddress address, std::uint64_t bytes) const {
  if (address <= size_bytes_ && bytes <= size_bytes_ - address) return;
  throw cn::MachineFault("access of " + std::to_string(bytes) + " bytes at " + hexadecimal(address) +
                         ", mono memory is 0x0 to " + hexadecimal(size_bytes_ - 1));
}

const void* MonoWindow::view(cn::MonoAddress address, std::uint64_t bytes,
                             tlm::tlm_fw_transport_if<>& memory) {
  check_range(address, bytes);
  if (has_pointer(memory)) return mono_ + address;
  std::vector<std::uint8_t>& copy = copies_[address];
  if (copy.size() < bytes) copy.resize(bytes);
  debug(tlm::TLM_READ_COMMAND, address, copy.data(), bytes, memory);
  return copy.data();
}

void MonoWindow::write(cn::MonoAddress address, const void* from, std::uint64_t bytes,
                       tlm::tlm_fw_transport_if<>& memory) {
  check_range(address, bytes);
  if (has_pointer(memory)) {
    std::memcpy(mono_ + address, from, bytes);
  } else {
    std::vector<std::uint8_t> data(bytes);
    std::memcpy(data.data(), from, bytes);
    debug(tlm::TLM_WRITE_COMMAND, address, data.data(), bytes, memory);
  }
}

void MonoWindow::debug(tlm::tlm_command command, cn::MonoAddress address, std::uint8_t* data,
                       std::uint64_t bytes, tlm::tlm_fw_transport_if<>& memory) {
  tlm::tlm_generic_payload transaction;
  set_access(transaction, command, address, data, bytes);
  const unsigned int moved = memory.transport_dbg(transaction);
  if (moved == bytes) return;
  throw cn::MachineFault("debug access of the PIO engine: mono memory moved " + std::to_string(moved) +
                         " of " + std::to_string(bytes) + " bytes at " + std::to_string(address) +
                         ", though it is configured with " + std::to_string(size_bytes_));
}

}  // namespace model
