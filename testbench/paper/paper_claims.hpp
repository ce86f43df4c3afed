#pragma once

#include <string>
#include <vector>

#include "testbench/paper/claim_runs.hpp"

namespace testbench {

enum class Verdict : std::uint8_t { holds, partly, fails };
const char* name_of(Verdict verdict);

/// What the measurements say of a claim.
struct Judgement {
  Verdict verdict;
  std::string figure;
};

/// A statement of the paper that measurements can support or refute.
struct PaperClaim {
  const char* section;
  const char* says;       ///< in this project's words
  const char* criterion;  ///< when it holds
  const char* command;    ///< what shows the same in full
  Judgement (*judge)(const ClaimMeasurements&);
};

/// In the paper's order. The one list: a further claim is a further row, and a run in claim_runs.cpp if it
/// needs one.
const std::vector<PaperClaim>& paper_claims();

}  // namespace testbench
