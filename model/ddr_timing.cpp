#include "model/ddr_timing.hpp"

#include <algorithm>

namespace model {

DdrTiming::DdrTiming(const ChipConfig::Ddr& config)
    : page_bytes_(std::uint64_t(config.page_bytes)),
      banks_(std::uint64_t(config.banks)),
      bytes_per_cycle_(std::uint64_t(config.bytes_per_cycle)),
      page_hit_cycles_(Cycles(config.page_hit_cycles)),
      page_miss_cycles_(Cycles(config.page_miss_cycles)),
      turn_round_cycles_(Cycles(config.turn_round_cycles)),
      refresh_interval_cycles_(Cycles(config.refresh_interval_cycles)),
      refresh_cycles_(Cycles(config.refresh_cycles)),
      ecc_cycles_(Cycles(config.ecc_cycles)),
      bank_(std::size_t(config.banks)),
      next_refresh_(config.refresh_interval_cycles == 0 ? ~Cycles{0}
                                                        : Cycles(config.refresh_interval_cycles)) {}

DdrTiming::Access DdrTiming::access(cn::MonoAddress address, std::uint64_t bytes, bool write,
                                    Cycles arrival) {
  if (bytes == 0) return {arrival, arrival, true};
  (write ? statistics_.bytes_written : statistics_.bytes_read) += bytes;
  const BusDirection direction = write ? BusDirection::write : BusDirection::read;
  std::uint64_t page = page_bytes_.quotient(address);
  std::uint64_t in_page = std::min(bytes, page_bytes_.value() - page_bytes_.remainder(address));
  bool hit = access_page(page, in_page, direction, arrival);
  const Cycles start = transfer_start_;
  while ((bytes -= in_page) > 0) {
    in_page = std::min(bytes, page_bytes_.value());
    hit &= access_page(++page, in_page, direction, arrival);
  }
  return {start, bus_free_ + ecc_cycles_, hit};
}

bool DdrTiming::access_page(std::uint64_t page, std::uint64_t bytes, BusDirection direction, Cycles arrival) {
  refresh_until(std::max(arrival, bus_free_));
  Bank& bank = bank_[banks_.remainder(page)];
  const std::uint64_t row = banks_.quotient(page);
  const bool hit = bank.open_row == row;
  const Cycles command = std::max(arrival, bank.ready);
  const Cycles data_ready = command + (hit ? page_hit_cycles_ : page_miss_cycles_);
  Cycles bus_ready = bus_free_;
  if (direction != bus_direction_) {
    if (bus_direction_ != BusDirection::unused) {
      bus_ready += turn_round_cycles_;
      ++statistics_.turn_rounds;
    }
    bus_direction_ = direction;
  }
  const Cycles transfer_cycles = bytes_per_cycle_.quotient(bytes + bytes_per_cycle_.value() - 1);
  transfer_start_ = std::max(data_ready, bus_ready);
  bus_free_ = transfer_start_ + transfer_cycles;
  bank.open_row = row;
  bank.ready = bus_free_ - page_hit_cycles_;
  ++(hit ? statistics_.page_hits : statistics_.page_misses);
  statistics_.busy_cycles += transfer_cycles;
  return hit;
}

void DdrTiming::refresh_until(Cycles now) {
  if (now < next_refresh_) return;
  // Of several refreshes that passed unobserved only the latest can still be felt.
  const Cycles due = (now - next_refresh_) / refresh_interval_cycles_ + 1;
  const Cycles latest = next_refresh_ + (due - 1) * refresh_interval_cycles_;
  const Cycles over = std::max(latest, bus_free_) + refresh_cycles_;
  for (Bank& bank : bank_) bank = {kNoRow, over};
  statistics_.refreshes += due;
  next_refresh_ = latest + refresh_interval_cycles_;
}

}  // namespace model
