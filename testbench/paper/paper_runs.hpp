#pragma once

#include <functional>
#include <vector>

#include "testbench/paper/paper.hpp"
#include "testbench/run/render.hpp"

namespace testbench {

/// Returns the simulated seconds for 1,000,000 path segments of each cell. Each run has a process of its own;
/// cells that one run measures are run once. `options` gives chip, samples and what the cells leave open of
/// the firmware.
/// @param done called with the share of finished runs
std::vector<double> run_paper_cells(const Scene& scene, const RenderOptions& options,
                                    const std::vector<PaperCell>& cells, int at_once,
                                    const std::function<void(double share)>& done = {});

}  // namespace testbench
