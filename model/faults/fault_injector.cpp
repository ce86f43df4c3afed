#include "model/faults/fault_injector.hpp"

#include <algorithm>
#include <string>

#include "firmware/cn/machine.hpp"

namespace model {
namespace {

constexpr int kFlippedWordBytes = 8;

bool concerns_signals(FaultKind kind) {
  return kind == FaultKind::pio_lost || kind == FaultKind::pio_late || kind == FaultKind::pio_doubled;
}

std::uint64_t bit_of_word(const Fault& fault) {
  return std::uint64_t{1} << (fault.address % kFlippedWordBytes * 8 + std::uint64_t(fault.bit));
}

}  // namespace

FaultInjector::FaultInjector(std::vector<Fault> faults, cn::PolyMemory& poly, Ddr ddr)
    : poly_(poly), ddr_(ddr) {
  std::stable_sort(faults.begin(), faults.end(),
                   [](const Fault& a, const Fault& b) { return a.cycle > b.cycle; });
  for (const Fault& fault : faults) {
    if (concerns_signals(fault.kind))
      signals_.push_back(fault);
    else if (fault.kind == FaultKind::poly_register)
      registers_.push_back({fault, {}});
    else
      at_a_time_.push_back(fault);
  }
}

FaultInjector::Words FaultInjector::words_of(int pe) const {
  const int bytes = poly_.capacity_bytes() + cn::PolyMemory::kReservedBytes;
  Words words;
  for (int offset = 0; offset < bytes; offset += kFlippedWordBytes) words.push_back(poly_.word(pe, offset));
  return words;
}

void FaultInjector::remember_words() {
  for (RegisterFault& of : registers_) of.before = words_of(of.fault.pe);
}

void FaultInjector::time_passes(Cycles now) {
  throw_if_detected();
  while (!at_a_time_.empty() && is_due(at_a_time_.back(), now)) {
    inject(at_a_time_.back());
    at_a_time_.pop_back();
  }
  remember_words();
}

void FaultInjector::kernel_ends(Cycles end) {
  for (const StuckPe& stuck : stuck_)
    for (std::size_t i = 0; i < stuck.kept.size(); ++i)
      poly_.word(stuck.pe, int(i) * kFlippedWordBytes) = stuck.kept[i];
  const auto over = std::remove_if(registers_.begin(), registers_.end(), [&](const RegisterFault& of) {
    if (!is_due(of.fault, end)) return false;
    flip_stored_word(of);
    return true;
  });
  registers_.erase(over, registers_.end());
  time_passes(end);
}

void FaultInjector::inject(const Fault& fault) {
  ++counts_.injected;
  if (fault.kind == FaultKind::poly_sram)
    poly_.word(fault.pe, int(fault.address) / kFlippedWordBytes * kFlippedWordBytes) ^= bit_of_word(fault);
  else if (fault.kind == FaultKind::enable_off)
    stuck_.push_back({fault.pe, words_of(fault.pe)});
  else
    flip_ddr(fault);
  // What a stuck PE keeps may have flipped.
  for (StuckPe& stuck : stuck_) stuck.kept = words_of(stuck.pe);
}

void FaultInjector::flip_ddr(const Fault& fault) {
  const bool doubled = fault.kind == FaultKind::ddr_double;
  if (!ddr_.has_ecc) {
    ddr_.bytes[fault.address] ^= std::uint8_t((doubled ? 3u : 1u) << fault.bit);
    return;
  }
  std::uint64_t& wrong = wrong_bits_[fault.address / kFlippedWordBytes];
  wrong ^= bit_of_word(fault) * (doubled ? 3 : 1);
  if (wrong == 0) wrong_bits_.erase(fault.address / kFlippedWordBytes);
}

void FaultInjector::flip_stored_word(const RegisterFault& of) {
  ++counts_.injected;
  const Words now = words_of(of.fault.pe);
  std::vector<std::size_t> stored;
  for (std::size_t i = 0; i < now.size() && i < of.before.size(); ++i)
    if (now[i] != of.before[i]) stored.push_back(i);
  if (stored.empty()) return;
  const std::size_t word = stored[of.fault.address % stored.size()];
  poly_.word(of.fault.pe, int(word) * kFlippedWordBytes) ^= std::uint64_t{1} << of.fault.bit;
}

cn::LaneMask FaultInjector::enabled_for_transfer(const cn::LaneMask& enabled) const {
  cn::LaneMask in_truth = enabled;
  for (const StuckPe& stuck : stuck_) in_truth.set(stuck.pe, false);
  return in_truth;
}

std::vector<Cycles> FaultInjector::signals(Cycles at) {
  if (signals_.empty() || !is_due(signals_.back(), at)) return {at};
  const Fault fault = signals_.back();
  signals_.pop_back();
  ++counts_.injected;
  if (fault.kind == FaultKind::pio_lost) return {};
  if (fault.kind == FaultKind::pio_late) return {at + fault.late_cycles};
  return {at, at};
}

void FaultInjector::accesses_ddr(cn::MonoAddress address, std::uint64_t bytes, bool write) {
  if (wrong_bits_.empty() || bytes == 0) return;
  auto word = wrong_bits_.lower_bound(address / kFlippedWordBytes);
  while (word != wrong_bits_.end() && word->first <= (address + bytes - 1) / kFlippedWordBytes) {
    const cn::MonoAddress first = word->first * kFlippedWordBytes;
    const bool is_replaced = write && first >= address && first + kFlippedWordBytes <= address + bytes;
    const bool is_single = (word->second & (word->second - 1)) == 0;
    word = wrong_bits_.erase(word);
    if (is_replaced) continue;
    if (is_single) {
      ++counts_.corrected;
      continue;
    }
    if (counts_.detected++ == 0) first_detected_ = first;
  }
}

void FaultInjector::throw_if_detected() const {
  if (counts_.detected > 0)
    throw cn::MachineFault(std::string(kEccMessage) + "the word of the DDR at mono address " +
                           std::to_string(first_detected_) + " has more wrong bits than can be corrected");
}

}  // namespace model
