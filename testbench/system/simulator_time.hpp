#pragma once

#include <cstdint>

namespace testbench {

/// Times this process.
class SimulatorTimer {
 public:
  SimulatorTimer();
  double cpu_seconds() const;
  double wall_seconds() const;

 private:
  double cpu_start_;
  double wall_start_;
};

/// The most memory this process has had in use.
std::uint64_t peak_bytes();

}  // namespace testbench
