#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include "firmware/cn/chip/lane_mask.hpp"
#include "firmware/cn/chip/mono_memory.hpp"
#include "firmware/cn/chip/poly_memory.hpp"
#include "model/faults/fault.hpp"

namespace model {

/// Carries out the faults of one array and the DDR. The units report to it where time passes, so a fault
/// comes before the first access that the control unit orders after its cycle.
///
/// - Registers are the simulator's own while a kernel computes. A flip is made in a word that the kernel in
///   progress stores (one that it changes); if it stores none on that PE, the register was dead.
/// - An enable bit that is stuck off keeps a PE from storing, and from transfers; its registers still take
///   part in tests of all PEs.
/// - With ECC (SECDED over 64 bits, as modules of 72 bits have), a word of the DDR with one wrong bit is
///   corrected when it is read or written in part. One with more is reported to the control unit, whose next
///   operation throws cn::MachineFault. Three and more may pass as one in a real decoder, which is not
///   modelled. A write of the whole word replaces either.
class FaultInjector {
 public:
  struct Ddr {
    std::uint8_t* bytes;
    bool has_ecc;
  };

  /// Memories must outlive the injector. Every place of a fault must exist.
  FaultInjector(std::vector<Fault> faults, cn::PolyMemory& poly, Ddr ddr);

  void firmware_starts(Cycles at) { start_ = at; }
  /// The control unit has come to `now`. Throws as throw_if_detected() does.
  void time_passes(Cycles now);
  /// A kernel has stored its results and is over at `end`.
  void kernel_ends(Cycles end);
  /// The PEs of a transfer that are enabled in truth.
  cn::LaneMask enabled_for_transfer(const cn::LaneMask& enabled) const;
  /// When the signals of a request arrive that is over at `at`.
  std::vector<Cycles> signals(Cycles at);
  void accesses_ddr(cn::MonoAddress address, std::uint64_t bytes, bool write);
  /// Throws cn::MachineFault if a word beyond correction was read.
  void throw_if_detected() const;

  const FaultCounts& counts() const { return counts_; }

 private:
  using Words = std::vector<std::uint64_t>;  ///< of one PE's SRAM
  struct RegisterFault {
    Fault fault;
    Words before;  ///< the kernel in progress
  };
  struct StuckPe {
    int pe;
    Words kept;
  };

  bool is_due(const Fault& fault, Cycles now) const { return start_ + fault.cycle <= now; }
  void inject(const Fault& fault);
  void flip_ddr(const Fault& fault);
  void flip_stored_word(const RegisterFault& of);
  Words words_of(int pe) const;
  void remember_words();

  cn::PolyMemory& poly_;
  Ddr ddr_;
  Cycles start_ = 0;
  FaultCounts counts_;
  cn::MonoAddress first_detected_ = 0;  ///< if counts_.detected is not 0
  std::vector<Fault> at_a_time_;        ///< SRAM, DDR and enable bits; the last one is next
  std::vector<RegisterFault> registers_;
  std::vector<Fault> signals_;
  std::vector<StuckPe> stuck_;
  std::map<cn::MonoAddress, std::uint64_t> wrong_bits_;  ///< of words that ECC has yet to see, by number
};

}  // namespace model
