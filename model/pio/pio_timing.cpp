#include "model/pio/pio_timing.hpp"

#include <algorithm>

namespace model {

PioTiming::PioTiming(const ChipConfig::Pio& config)
    : setup_cycles_(Cycles(config.setup_cycles)),
      per_pe_cycles_(Cycles(config.per_pe_cycles)),
      bytes_per_cycle_(std::uint64_t(config.bytes_per_cycle)),
      misalignment_cycles_(Cycles(config.misalignment_cycles)) {}

Cycles PioTiming::data_cycles(const MonoPieces& pieces) const {
  return cycles_for(std::uint64_t(pieces.bytes_per_pe()), bytes_per_cycle_);
}

Cycles PioTiming::address_cycles(const MonoPieces& pieces, int piece) const {
  const auto misaligned_up_to = [&](int end) {
    return Cycles(pieces.misaligned()) * Cycles(end) / Cycles(pieces.pieces());
  };
  return per_pe_cycles_ + (misaligned_up_to(piece + 1) - misaligned_up_to(piece)) * misalignment_cycles_;
}

Cycles PioTiming::pe_cycles(const MonoPieces& pieces) const {
  return Cycles(pieces.pieces()) * (per_pe_cycles_ + data_cycles(pieces)) +
         Cycles(pieces.misaligned()) * misalignment_cycles_;
}

Cycles PioTiming::memory_start(const MonoPieces& pieces, Cycles start) const {
  return start + setup_cycles_ + per_pe_cycles_ + (pieces.write() ? data_cycles(pieces) : 0);
}

Cycles PioTiming::finish(const MonoPieces& pieces, Cycles start, Cycles memory_end) const {
  const Cycles pe_side_end = start + setup_cycles_ + pe_cycles(pieces);
  return std::max(pe_side_end, memory_end + (pieces.write() ? 0 : data_cycles(pieces)));
}

}  // namespace model
