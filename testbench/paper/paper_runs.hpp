#pragma once

#include <functional>
#include <vector>

#include "testbench/paper/paper.hpp"
#include "testbench/run/render.hpp"

namespace testbench {

/// Simulated seconds for 1,000,000 path segments of each cell, one process a run. `options` gives chip,
/// samples and what the cell leaves open of the firmware. Cells that the firmware runs alike are run once.
/// @param done is told the share of runs finished
std::vector<double> run_paper_cells(const Scene& scene, const RenderOptions& options,
                                    const std::vector<PaperCell>& cells, int at_once,
                                    const std::function<void(double share)>& done = {});

}  // namespace testbench
