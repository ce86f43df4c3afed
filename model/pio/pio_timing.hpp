#pragma once

#include "firmware/cn/chip/transfer.hpp"
#include "model/config/chip_config.hpp"
#include "model/time/cycles.hpp"
#include "model/transaction/mono_pieces.hpp"

namespace model {

/// The time of a request in the PIO engine.
///
/// The engine spends setup_cycles on a request, then takes its PEs one by one: per_pe_cycles to read and send
/// a PE's address, then its data at bytes_per_cycle, plus misalignment_cycles where they apply. This PE side
/// is never shared between two PEs. The memory side runs beside it:
/// - Read: the first address leaves after setup and one address phase; the engine goes on to later addresses
///   while it waits (transaction ids, US 7,363,472), so memory latency hides behind PE work. Data cannot be
///   written to a PE before they have arrived: the request ends with the PE side, or one data phase after the
///   memory's last byte has arrived, whichever is later. A read of one PE thus pays the whole latency.
/// - Write: posted. The memory side starts when the first PE's data are there. The request ends with the PE
///   side unless the memory takes data more slowly; then it pushes back and the request ends when it has
///   taken the last byte. Data in flight are not waited for: a later access through the same path cannot
///   overtake them.
class PioTiming {
 public:
  explicit PioTiming(const ChipConfig::Pio& config);

  Cycles setup_cycles() const { return setup_cycles_; }
  /// Cycles to read and send the address of one piece. Misalignment is spread evenly over the pieces.
  Cycles address_cycles(const MonoPieces& pieces, int piece) const;
  /// Cycles of the data of one piece.
  Cycles data_cycles(const MonoPieces& pieces) const;
  /// Cycles of the PE side of all pieces, without setup: the sum of the above.
  Cycles pe_cycles(const MonoPieces& pieces) const;
  /// When the memory side of a request that starts at `start` begins.
  Cycles memory_start(const MonoPieces& pieces, Cycles start) const;
  /// When the request is over.
  /// @param memory_end when the last byte has arrived at the engine (read) or at the memory (write)
  Cycles finish(const MonoPieces& pieces, Cycles start, Cycles memory_end) const;

 private:
  Cycles setup_cycles_;
  Cycles per_pe_cycles_;
  std::uint64_t bytes_per_cycle_;
  Cycles misalignment_cycles_;
};

}  // namespace model
