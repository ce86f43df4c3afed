#pragma once

#include <string>
#include <vector>

namespace testbench {

/// CPU seconds of one kind of run, repeated. Kinds that are compared run in turn, so that the n-th times of
/// two of them met the same neighbours on the machine.
struct RunTimes {
  std::vector<double> cpu_seconds;

  double median() const;
};

/// The median of `values`, of which there is at least one; of an even number the mean of the middle two.
double median(std::vector<double> values);

/// How many times longer a run of `slow` takes: the median over the repetitions of both run one after the
/// other. A machine that is slowed down for a while slows both and leaves the ratio.
double ratio(const RunTimes& slow, const RunTimes& fast);

}  // namespace testbench
