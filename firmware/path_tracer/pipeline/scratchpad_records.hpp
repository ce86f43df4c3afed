#pragma once

#include "firmware/path_tracer/program/layout.hpp"
#include "firmware/path_tracer/stages/transfer_ring.hpp"

namespace path_tracer {

/// Arrays of the scene that the firmware has copied to the memory on the chip (ProgramConfig::scratchpad),
/// from where all transfers and the control unit load them then.
class ScratchpadRecords {
 public:
  /// Copies by programmed I/O, through `buffers`, and lets `layout` point to the copies. Throws ProgramError
  /// for an array that was asked for by name and does not fit.
  ScratchpadRecords(cn::Machine& machine, TransferRing& buffers, Scratchpad wanted, Layout& layout);

 private:
  template <class T>
  void take(const char* region, bool must_fit, cn::MonoPointer<T>& array);
  void copy(cn::MonoAddress from, cn::MonoAddress to, std::uint64_t bytes);
  void copy_pieces(cn::MonoAddress from, cn::MonoAddress to, int piece_bytes, int pes);

  cn::Machine& machine_;
  TransferRing& buffers_;
  const Layout& layout_;
  cn::MonoRange memory_;
  cn::MonoAddress next_;
};

}  // namespace path_tracer
