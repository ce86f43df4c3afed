#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "testbench/statistics/render_report.hpp"
#include "testbench/system/ranks.hpp"

namespace testbench {

/// A render whose samples several ranks shared, each on a machine of its own.
struct RankRender {
  Film film;  ///< the same bits as one rank would have made
  std::uint64_t segments = 0;
  double cpu_seconds = 0;                   ///< of all ranks
  std::optional<double> simulated_seconds;  ///< of the chip that took longest
  bool is_partial = false;                  ///< some rank was interrupted
  nlohmann::ordered_json statistics;  ///< format csx600-rank-statistics-2: sums, and each rank's own file
};

/// All ranks call it with the same request; the first returns the render, the others none. Throws what
/// render_on_chip() does, on the first rank also for the others.
std::optional<RankRender> render_on_ranks(Ranks& ranks, const Scene& scene, const RenderRequest& request,
                                          const RenderProgress& progress);

/// Gives the options the paths of one rank; those of all ranks are theirs.
void take_share(RenderOptions& options, int rank, int ranks);

}  // namespace testbench
