#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "testbench/paper/paper_claims.hpp"

namespace testbench {

/// A claim of the paper and what came of it.
struct JudgedClaim {
  const PaperClaim* claim;
  Judgement judgement;
};

/// Makes the runs that the claims need and judges each. Shows progress.
/// @param options give chip, timing, level and samples; the film is the box's
std::vector<JudgedClaim> judge_claims(const Scene& box, const RenderOptions& options, int jobs);

/// Each claim with its figure, its criterion and a command, for people.
std::string claims_text(const std::vector<JudgedClaim>& claims);

nlohmann::ordered_json claims_json(const std::vector<JudgedClaim>& claims, const RenderOptions& options);

}  // namespace testbench
