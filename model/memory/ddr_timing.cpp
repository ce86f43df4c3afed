#include "model/memory/ddr_timing.hpp"

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

/// A burst: accesses of one direction that arrive together. It holds the state that each page access leaves
/// to the next, so that the compiler can keep it in registers, and writes it back once. A gather has a
/// hundred page accesses, each of which depends on the one before: 4 million segments take 65 ms so, and 103
/// ms with the state in memory.
///
/// @tparam Division PowerOfTwo where the memory's numbers allow it, else Divisor
/// @tparam may_be_observed whether an observer may have asked for commands
template <class Division, bool may_be_observed>
class DdrTiming::Burst {
 public:
  Burst(DdrTiming& ddr, BusDirection direction, Cycles arrival)
      : ddr_(ddr),
        bank_(ddr.bank_.data()),
        page_bytes_(ddr.page_bytes_),
        banks_(ddr.banks_),
        bytes_per_cycle_(ddr.bytes_per_cycle_),
        page_hit_cycles_(ddr.page_hit_cycles_),
        page_miss_cycles_(ddr.page_miss_cycles_),
        arrival_(arrival),
        turn_round_(ddr.turn_round(direction)),
        bus_free_(ddr.bus_free_),
        next_refresh_(ddr.next_refresh_) {}

  /// Returns the first byte's cycle on the data bus.
  [[gnu::always_inline]] inline Cycles access(cn::MonoAddress address, std::uint64_t bytes) {
    bytes_ += bytes;
    std::uint64_t page = page_bytes_.quotient(address);
    std::uint64_t in_page = std::min(bytes, page_bytes_.value() - page_bytes_.remainder(address));
    const Cycles start = access_page(page, in_page);
    while ((bytes -= in_page) > 0) {
      in_page = std::min(bytes, page_bytes_.value());
      access_page(++page, in_page);
    }
    return start;
  }

  /// Writes the state back.
  Access finish(Cycles start) {
    DdrStatistics& statistics = ddr_.statistics_;
    (ddr_.bus_direction_ == BusDirection::write ? statistics.bytes_written : statistics.bytes_read) += bytes_;
    statistics.page_hits += pages_ - misses_;
    statistics.page_misses += misses_;
    statistics.busy_cycles += busy_cycles_;
    ddr_.bus_free_ = bus_free_;
    if (ddr_.observer_ != nullptr)
      ddr_.observer_->accessed(ddr_.bus_direction_ == BusDirection::write, start, bus_free_);
    return {start, bus_free_ + ddr_.ecc_cycles_, misses_ == 0};
  }

 private:
  /// Accesses a piece within one page.
  [[gnu::always_inline]] inline Cycles access_page(std::uint64_t page, std::uint64_t bytes) {
    const Cycles transfer_cycles = bytes_per_cycle_.quotient(bytes + bytes_per_cycle_.value() - 1);
    busy_cycles_ += transfer_cycles;
    ++pages_;
    if (page == page_ && bus_free_ < next_refresh_) {
      // Its row is open and its command went out while the access before was on the bus.
      const Cycles start = bus_free_;
      bus_free_ += transfer_cycles;
      bank_[banks_.remainder(page)].ready = bus_free_ - page_hit_cycles_;
      report(page, true, start - page_hit_cycles_, start);
      return start;
    }
    page_ = page;
    const Cycles now = std::max(arrival_, bus_free_);
    if (now >= next_refresh_) refresh(now);
    Bank& bank = bank_[banks_.remainder(page)];
    const bool hit = bank.open_page == page;
    const Cycles command = std::max(arrival_, bank.ready);
    const Cycles data_ready = command + (hit ? page_hit_cycles_ : page_miss_cycles_);
    const Cycles start = std::max(data_ready, bus_free_ + turn_round_);
    turn_round_ = 0;
    bus_free_ = start + transfer_cycles;
    bank.open_page = page;
    bank.ready = bus_free_ - page_hit_cycles_;
    misses_ += !hit;
    report(page, hit, command, start);
    return start;
  }

  /// Rare, so it is a function apart from the code that runs for every page.
  [[gnu::noinline, gnu::cold]] static Cycles refresh_until(DdrTiming& ddr, Cycles now, Cycles bus_free) {
    ddr.bus_free_ = bus_free;
    ddr.refresh_until(now);
    return ddr.next_refresh_;
  }
  void refresh(Cycles now) { next_refresh_ = refresh_until(ddr_, now, bus_free_); }
  void report(std::uint64_t page, bool hit, Cycles command, Cycles start) {
    if constexpr (!may_be_observed) return;
    if (ddr_.command_observer_ == nullptr) return;
    ddr_.report_commands(banks_.remainder(page), banks_.quotient(page), hit, command, start, bus_free_);
  }

  // Copies of constants: for all the compiler knows, a store to a bank could change the originals.
  DdrTiming& ddr_;
  Bank* const bank_;
  const Division page_bytes_;
  const Division banks_;
  const Division bytes_per_cycle_;
  const Cycles page_hit_cycles_;
  const Cycles page_miss_cycles_;
  const Cycles arrival_;
  Cycles turn_round_;
  Cycles bus_free_;
  Cycles next_refresh_;
  std::uint64_t page_ = kNoPage;  ///< page of the access before
  std::uint64_t bytes_ = 0;
  std::uint64_t pages_ = 0;
  std::uint64_t misses_ = 0;
  Cycles busy_cycles_ = 0;
};

void DdrTiming::report_commands(std::size_t bank, std::uint64_t row, bool hit, Cycles command, Cycles start,
                                Cycles finish) {
  const bool write = bus_direction_ == BusDirection::write;
  const int number = static_cast<int>(bank);
  if (!hit) command_observer_->commanded(number, DdrCommand::activate, row, command);
  command_observer_->commanded(number, write ? DdrCommand::write : DdrCommand::read, row,
                               start - page_hit_cycles_);
  command_observer_->moved_data(write, start, finish);
}

template <class Use>
DdrTiming::Access DdrTiming::book(bool write, Cycles arrival, const Use& use) {
  const BusDirection direction = write ? BusDirection::write : BusDirection::read;
  const bool shifts =
      page_bytes_.is_power_of_two() && banks_.is_power_of_two() && bytes_per_cycle_.is_power_of_two();
  if (shifts && command_observer_ == nullptr) {
    Burst<PowerOfTwo, false> burst(*this, direction, arrival);
    return burst.finish(use(burst));
  }
  Burst<Divisor, true> burst(*this, direction, arrival);
  return burst.finish(use(burst));
}

DdrTiming::Access DdrTiming::access(cn::MonoAddress address, std::uint64_t bytes, bool write,
                                    Cycles arrival) {
  if (bytes == 0) return {arrival, arrival, true};
  return book(write, arrival, [&](auto& burst) { return burst.access(address, bytes); });
}

DdrTiming::Access DdrTiming::access(const MonoPieces::Runs& runs, bool write, Cycles arrival) {
  if (runs.empty()) return {arrival, arrival, true};
  return book(write, arrival, [&](auto& burst) {
    auto run = runs.begin();
    const Cycles start = burst.access(run->address, run->bytes);
    for (++run; run != runs.end(); ++run) burst.access(run->address, run->bytes);
    return start;
  });
}

Cycles DdrTiming::turn_round(BusDirection direction) {
  if (direction == bus_direction_) return 0;
  const bool first_use = bus_direction_ == BusDirection::unused;
  bus_direction_ = direction;
  if (first_use) return 0;
  ++statistics_.turn_rounds;
  return turn_round_cycles_;
}

void DdrTiming::refresh_until(Cycles now) {
  // When several refreshes have passed unobserved, only the latest can still delay an access.
  const Cycles due = (now - next_refresh_) / refresh_interval_cycles_ + 1;
  const Cycles latest = next_refresh_ + (due - 1) * refresh_interval_cycles_;
  const Cycles over = std::max(latest, bus_free_) + refresh_cycles_;
  for (Bank& bank : bank_) bank = {kNoPage, over};
  if (command_observer_ != nullptr)
    command_observer_->commanded(-1, DdrCommand::refresh, 0, over - refresh_cycles_);
  statistics_.refreshes += due;
  next_refresh_ = latest + refresh_interval_cycles_;
}

}  // namespace model
