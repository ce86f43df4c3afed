#pragma once

#include <string>
#include <utility>
#include <vector>

#include "testbench/faults/fault_outcome.hpp"
#include "testbench/faults/fault_store.hpp"

namespace testbench {

/// The interval that holds a share with a confidence of 95 %, of which `hits` of `runs` were seen: Wilson,
/// Probable Inference, the Law of Succession, and Statistical Inference, JASA 22, 1927. [0, 1] without runs.
std::pair<double, double> wilson_interval(int hits, int runs);

/// The runs of a campaign with faults of one kind.
struct FaultRow {
  std::string kind;
  int runs = 0;
  std::array<int, kFaultOutcomes.size()> by_outcome{};

  /// Runs that gave no right image: over `runs`, the vulnerability factor of what broke.
  int vulnerable() const;
};

/// A row for each kind that was run, in the order of model::kFaultKinds.
std::vector<FaultRow> fault_rows(const FaultStore& store);
/// For people: counts, vulnerability factor and its interval.
std::string fault_table(const std::vector<FaultRow>& rows);
std::string fault_csv(const std::vector<FaultRow>& rows);

}  // namespace testbench
