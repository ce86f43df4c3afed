#include "model/control/control_statistics.hpp"

#include <numeric>

namespace model {

Cycles ControlStatistics::total() const {
  return std::accumulate(cycles.begin(), cycles.end(), Cycles{0});
}

PioWaits ControlStatistics::pio_waits() const {
  return {(*this)[CycleCause::wait_load], (*this)[CycleCause::wait_save],
          (*this)[CycleCause::wait_pio_queue]};
}

}  // namespace model
