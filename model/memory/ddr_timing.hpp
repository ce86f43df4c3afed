#pragma once

#include <cstdint>
#include <vector>

#include "firmware/cn/chip/mono_memory.hpp"
#include "model/config/chip_config.hpp"
#include "model/observe/memory_observer.hpp"
#include "model/time/cycles.hpp"
#include "model/transaction/divisor.hpp"
#include "model/transaction/mono_pieces.hpp"

namespace model {

struct DdrStatistics {
  std::uint64_t page_hits = 0;
  std::uint64_t page_misses = 0;
  std::uint64_t bytes_read = 0;
  std::uint64_t bytes_written = 0;
  std::uint64_t busy_cycles = 0;  ///< cycles in which the data bus transfers
  std::uint64_t turn_rounds = 0;
  std::uint64_t refreshes = 0;
};

/// The timing of a DDR2 memory with open pages. Bank = (address / page) mod banks, row = address / (page *
/// banks).
///
/// - The data bus is one resource, at `bytes_per_cycle`; a change of direction leaves it idle for
/// `turn_round_cycles`.
/// - A page hit transfers `page_hit_cycles` after its command. That latency is pipelined: hits that arrive
///   together follow each other on the data bus without a gap.
/// - A page miss first spends (miss - hit) cycles on precharge and activation, which occupies only its bank.
///   A bank cannot change its row before the last column command of the access before, i.e. the end of that
///   transfer less the hit latency; so a miss right after an access to the same bank leaves the data bus idle
///   for (miss - hit) cycles, and misses in different banks overlap.
/// - Every `refresh_interval_cycles` all banks are busy for `refresh_cycles` and their rows close. A refresh
///   that falls into booked transfers is put off until they are over.
/// - `ecc_cycles` lengthen the latency of an access, not the occupation of the bus.
///
/// Contiguous accesses that arrive together take as long as one access over all their bytes, provided each is
/// a multiple of `bytes_per_cycle`. Accesses are served in the order of the calls.
class DdrTiming {
 public:
  struct Access {
    Cycles start;   ///< first byte on the data bus
    Cycles finish;  ///< after the last byte
    bool page_hit;  ///< every page that it touches was open
  };

  explicit DdrTiming(const ChipConfig::Ddr& config);

  Access access(cn::MonoAddress address, std::uint64_t bytes, bool write, Cycles arrival);
  /// Books accesses that arrive together, one after the other. Returns the start of the first and the finish
  /// of the last.
  Access access(const MonoPieces::Runs& runs, bool write, Cycles arrival);

  const DdrStatistics& statistics() const { return statistics_; }
  void set_observer(DdrObserver* observer, bool with_commands) {
    observer_ = observer;
    command_observer_ = with_commands ? observer : nullptr;
  }

 private:
  static constexpr std::uint64_t kNoPage = ~std::uint64_t{0};
  struct Bank {
    std::uint64_t open_page = kNoPage;  ///< number of the page in the memory, which names the row, too
    Cycles ready = 0;                   ///< when the row may change, or a refresh is over
  };
  enum class BusDirection : std::uint8_t { unused, read, write };

  template <class Division, bool may_be_observed>
  class Burst;
  /// Calls `use` with a burst and books what it accesses.
  template <class Use>
  Access book(bool write, Cycles arrival, const Use& use);
  /// Cycles for which the data bus rests before it moves data in that direction.
  Cycles turn_round(BusDirection direction);
  /// Books the refreshes due by `now`, at least one.
  void refresh_until(Cycles now);
  void report_commands(std::size_t bank, std::uint64_t row, bool hit, Cycles command, Cycles start,
                       Cycles finish);

  Divisor page_bytes_;
  Divisor banks_;
  Divisor bytes_per_cycle_;
  Cycles page_hit_cycles_;
  Cycles page_miss_cycles_;
  Cycles turn_round_cycles_;
  Cycles refresh_interval_cycles_;
  Cycles refresh_cycles_;
  Cycles ecc_cycles_;

  std::vector<Bank> bank_;
  Cycles bus_free_ = 0;
  BusDirection bus_direction_ = BusDirection::unused;
  Cycles next_refresh_;
  DdrObserver* observer_ = nullptr;
  DdrObserver* command_observer_ = nullptr;
  DdrStatistics statistics_;
};

}  // namespace model
