#pragma once

#include <functional>

#include "testbench/sweep/point_store.hpp"
#include "testbench/sweep/sweep_points.hpp"
#include "testbench/system/ranks.hpp"

namespace testbench {

struct SweepRunOptions {
  int jobs = 1;              ///< processes at a time on this rank
  bool in_full = false;      ///< no point is replayed
  double limit_seconds = 0;  ///< a point that takes longer fails; 0: no limit
};

/// Takes the finished share of the points that were left to do; returns false to stop.
using SweepProgress = std::function<bool(double share)>;

/// Runs every point that `store` does not hold, in processes of this machine and on the other ranks, and adds
/// each to the store as it finishes; points that fail are added as such. Points that share a stream of calls
/// are replayed from one recording. Returns false when `progress` stopped it. Throws RunError when the store
/// cannot be written.
bool run_sweep(const Sweep& sweep, PointStore& store, const SweepRunOptions& options, Ranks& ranks,
               const SweepProgress& progress);

/// What the other ranks do meanwhile: points that the first one hands out, until it has no more.
void serve_sweep(const Sweep& sweep, Ranks& ranks, double limit_seconds);

}  // namespace testbench
