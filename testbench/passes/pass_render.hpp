#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>

#include "testbench/passes/checkpoint.hpp"
#include "testbench/sampling/sample_plan.hpp"
#include "testbench/statistics/render_report.hpp"
#include "testbench/system/ranks.hpp"

namespace testbench {

/// Which clock a time budget is measured by.
enum class BudgetClock : std::uint8_t {
  chip,       ///< simulated time, from the firmware's start to its end, summed over the passes
  simulator,  ///< wall time of this program, from the first pass's start
};

struct TimeBudget {
  double seconds = 0;
  BudgetClock clock = BudgetClock::chip;
};

/// Why no further pass was made.
enum class PassEnd : std::uint8_t { plan_complete, time_over, interrupted };

/// A picture made in passes.
struct PassRender : PassSums {
  explicit PassRender(Film empty) : PassSums{std::move(empty)} {}

  PassEnd end = PassEnd::plan_complete;
  double wall_seconds = 0;            ///< with what is between the passes; of this process
  nlohmann::ordered_json statistics;  ///< format csx600-pass-statistics-1: sums, and each pass's own
};

/// What is done besides rendering.
struct PassActions {
  /// The film after a pass, numbered from 1.
  std::function<void(const Film& film, int pass)> after_pass = [](const Film&, int) {};
  RenderProgress progress;
  /// Of a plan that no clock or picture moves.
  std::optional<CheckpointOptions> checkpoint = {};
};

/// Renders in the passes that `plan` says; with a budget, none begins that is predicted to end too late.
/// The image depends on the plan, and with a budget on the clock; not on ranks, n or the machine. A render
/// that is interrupted ends behind its last whole pass.
///
/// All ranks call it with the same arguments; the first returns the render, the others none. Throws what
/// render_on_chip() does, on the first rank also for the others.
std::optional<PassRender> render_in_passes(Ranks& ranks, const Scene& scene, RenderRequest request,
                                           SamplePlan& plan, const std::optional<TimeBudget>& budget,
                                           const PassActions& actions);

}  // namespace testbench
