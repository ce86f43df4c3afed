#pragma once

#include <systemc>
#include <tlm>

#include "model/transaction/mono_pieces.hpp"

namespace model {

/// Ignorable extension: the addresses of all PEs of a gather or scatter in one transaction. Its generic
/// payload has TLM_IGNORE_COMMAND, so a target that does not know the extension does nothing; the initiator
/// then finds it not served and sends one ordinary transaction a run. A target that serves it charges the
/// time of all runs from the delay it was called with, in their order, and moves no data: the initiator moves
/// them by DMI or debug transport.
class PeAddresses : public tlm::tlm_extension<PeAddresses> {
 public:
  MonoPieces pieces;

  /// Set by the target: it knows the extension, and `first_data` (from sc_time_stamp(), as the delay) says
  /// when the first byte was on its way.
  bool served = false;
  sc_core::sc_time first_data;

  tlm::tlm_extension_base* clone() const override { return new PeAddresses(*this); }
  void copy_from(const tlm::tlm_extension_base& other) override {
    *this = static_cast<const PeAddresses&>(other);
  }
};

}  // namespace model
