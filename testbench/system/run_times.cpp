#include "testbench/system/run_times.hpp"

#include <algorithm>

namespace testbench {

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

double RunTimes::median() const {
  return testbench::median(cpu_seconds);
}

double ratio(const RunTimes& slow, const RunTimes& fast) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < std::min(slow.cpu_seconds.size(), fast.cpu_seconds.size()); ++i)
    ratios.push_back(slow.cpu_seconds[i] / fast.cpu_seconds[i]);
  return median(ratios);
}

}  // namespace testbench
