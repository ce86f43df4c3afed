#include "model/control/cycle_ledger.hpp"

namespace model {

PioWaits CycleLedger::take_waits() {
  const PioWaits waits = statistics_.pio_waits();
  const PioWaits since = waits - waits_taken_;
  waits_taken_ = waits;
  return since;
}

void CycleLedger::set_observer(ControlObserver* observer, Cycles sync_cycles) {
  observer_ = observer;
  sync_cycles_ = sync_cycles;
}

}  // namespace model
