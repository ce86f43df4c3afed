#include "testbench/system/simulator_time.hpp"

#include <sys/resource.h>

#include <ctime>

namespace testbench {
namespace {

double clock_seconds(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

}  // namespace

SimulatorTimer::SimulatorTimer()
    : cpu_start_(clock_seconds(CLOCK_PROCESS_CPUTIME_ID)), wall_start_(clock_seconds(CLOCK_MONOTONIC)) {}

double SimulatorTimer::cpu_seconds() const {
  return clock_seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu_start_;
}
double SimulatorTimer::wall_seconds() const {
  return clock_seconds(CLOCK_MONOTONIC) - wall_start_;
}

std::uint64_t peak_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return std::uint64_t(usage.ru_maxrss) * 1024;
}

}  // namespace testbench
