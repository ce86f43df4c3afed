#pragma once

#include <cstdint>

namespace testbench {

/// Times the simulator, that is, this process, not the chip.
class SimulatorTimer {
 public:
  SimulatorTimer();
  double cpu_seconds() const;
  double wall_seconds() const;

 private:
  double cpu_start_;
  double wall_start_;
};

/// The largest amount of memory that this process has used so far.
std::uint64_t peak_bytes();

}  // namespace testbench
