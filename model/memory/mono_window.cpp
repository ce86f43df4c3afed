#include "model/memory/mono_window.hpp"

#include <cstring>

#include "firmware/cn/machine.hpp"
#include "model/transaction/payload.hpp"

namespace model {
namespace {

std::string name_of(const cn::Transfer& transfer, std::uint64_t request) {
  return "PIO request " + std::to_string(request) + " (" +
         (transfer.direction == cn::Direction::mono_to_poly ? "mono to poly" : "poly to mono") +
         ", semaphore " + std::to_string(transfer.done.index) + "): ";
}

}  // namespace

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
  const int pe = cn::first_pe_not(transfer, poly_.num_pes(), [&](cn::MonoAddress address) {
    return map_->find(address, bytes) != AddressMap::kNowhere;
  });
  if (pe < 0) return;
  throw cn::MachineFault(name_of(transfer, request) + "PE " + std::to_string(pe) + " addresses " +
                         std::to_string(bytes) + " bytes at " + hexadecimal(transfer.mono[pe]) +
                         ", mono memory is " + map_->text());
}

/// Neighbouring pieces form one access, which no two memories can answer.
void MonoWindow::check_runs(const cn::Transfer& transfer, const MonoPieces& pieces,
                            std::uint64_t request) const {
  for (const MonoPieces::Run& run : pieces.runs())
    if (map_->find(run.address, run.bytes) == AddressMap::kNowhere)
      throw cn::MachineFault(name_of(transfer, request) + std::to_string(run.bytes) +
                             " bytes without a gap at " + hexadecimal(run.address) +
                             " lie in two memories, allowed is one of " + map_->text());
}

int MonoWindow::range_of(const MonoPieces& pieces) const {
  const cn::MonoRange& first = (*map_)[0].mono;
  if (first.first == 0 && pieces.within(first.bytes)) return 0;
  if (pieces.runs().empty()) return AddressMap::kNowhere;
  const int range = map_->find(pieces.runs().front().address, 1);
  if (range == AddressMap::kNowhere) return range;
  for (const MonoPieces::Run& run : pieces.runs())
    if (!(*map_)[range].mono.contains(run.address, run.bytes)) return AddressMap::kNowhere;
  return range;
}

int MonoWindow::range_of(const cn::Transfer& transfer) const {
  const auto bytes = std::uint64_t(transfer.poly.size_bytes);
  for (int range = 0; range < map_->size(); ++range) {
    const auto contains = [&](cn::MonoAddress address) {
      return (*map_)[range].mono.contains(address, bytes);
    };
    if (cn::first_pe_not(transfer, poly_.num_pes(), contains) < 0) return range;
  }
  return AddressMap::kNowhere;
}

void MonoWindow::move(const cn::Transfer& transfer, int range, tlm::tlm_fw_transport_if<>& memory) {
  std::uint8_t* const storage = range == AddressMap::kNowhere ? nullptr : pointer(range, memory);
  if (storage == nullptr) return move_by_debug(transfer, memory);
  cn::Transfer within_range = transfer;
  within_range.mono.first -= (*map_)[range].mono.first;
  cn::move_data(within_range, poly_, storage);
}

std::uint8_t* MonoWindow::pointer(int range, tlm::tlm_fw_transport_if<>& memory) {
  if (pointers_.size() <= std::size_t(range)) pointers_.resize(std::size_t(range) + 1);
  Pointer& pointer = pointers_[std::size_t(range)];
  if (pointer.answer == Answer::not_asked) {
    pointer.first = ask(range, memory);
    pointer.answer = pointer.first != nullptr ? Answer::granted : Answer::refused;
  }
  return pointer.first;
}

std::uint8_t* MonoWindow::ask(int range, tlm::tlm_fw_transport_if<>& memory) const {
  const cn::MonoRange& mono = (*map_)[range].mono;
  tlm::tlm_generic_payload transaction;
  transaction.set_write();
  transaction.set_address(mono.first);
  tlm::tlm_dmi dmi;
  const bool granted = memory.get_direct_mem_ptr(transaction, dmi) && dmi.is_read_write_allowed() &&
                       dmi.get_start_address() <= mono.first &&
                       dmi.get_end_address() >= mono.first + (mono.bytes - 1);
  return granted ? dmi.get_dmi_ptr() + (mono.first - dmi.get_start_address()) : nullptr;
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
  const int range = checked_range(address, bytes);
  if (const std::uint8_t* const storage = pointer(range, memory)) {
    std::memcpy(to, storage + (address - (*map_)[range].mono.first), bytes);
  } else {
    debug(tlm::TLM_READ_COMMAND, address, to, bytes, memory);
  }
}

int MonoWindow::checked_range(cn::MonoAddress address, std::uint64_t bytes) const {
  const int range = map_->find(address, bytes);
  if (range == AddressMap::kNowhere)
    throw cn::MachineFault("access of " + std::to_string(bytes) + " bytes at " + hexadecimal(address) +
                           ", mono memory is " + map_->text());
  return range;
}

const void* MonoWindow::view(cn::MonoAddress address, std::uint64_t bytes,
                             tlm::tlm_fw_transport_if<>& memory) {
  const int range = checked_range(address, bytes);
  if (const std::uint8_t* const storage = pointer(range, memory))
    return storage + (address - (*map_)[range].mono.first);
  std::vector<std::uint8_t>& copy = copies_[address];
  if (copy.size() < bytes) copy.resize(bytes);
  debug(tlm::TLM_READ_COMMAND, address, copy.data(), bytes, memory);
  return copy.data();
}

void MonoWindow::write(cn::MonoAddress address, const void* from, std::uint64_t bytes,
                       tlm::tlm_fw_transport_if<>& memory) {
  const int range = checked_range(address, bytes);
  if (std::uint8_t* const storage = pointer(range, memory)) {
    std::memcpy(storage + (address - (*map_)[range].mono.first), from, bytes);
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
                         ", though it is configured with " +
                         std::to_string((*map_)[checked_range(address, bytes)].mono.bytes));
}

}  // namespace model
