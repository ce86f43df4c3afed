#pragma once

#include <string>
#include <vector>

namespace testbench {

/// CPU seconds of one kind of run, one value per repetition. Kinds that are compared run in turn, so the n-th
/// repetitions of both met the same load of the machine.
struct RunTimes {
  std::vector<double> cpu_seconds;

  double median() const;
};

/// The median of at least one value; the mean of the two middle values if their number is even.
double median(std::vector<double> values);

/// How many times longer a run of `slow` takes than one of `fast`: the median of the ratios of their n-th
/// repetitions. A machine that is slow for a while slows both and leaves the ratio.
double ratio(const RunTimes& slow, const RunTimes& fast);

}  // namespace testbench
