#include "testbench/sensitivity/sensitivity.hpp"

#include <optional>

#include "testbench/statistics/json_file.hpp"
#include "testbench/sweep/point_work.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/processes.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;

SweepPoint on_chip(const SweepPoint& point, const model::ChipConfig& chip) {
  SweepPoint other = point;
  std::visit(
      [&](auto& run) {
        if constexpr (std::is_same_v<std::decay_t<decltype(run)>, RenderPoint>) {
          run.request.options.chip = chip;
        } else {
          run.options.chip = chip;
        }
      },
      other.run);
  return other;
}

RunFigures figures_of(const Json& statistics) {
  return {statistics["simulated_cycles"], statistics["simulated_seconds"],
          statistics["chip"]["energy"]["joules"]};
}

Json figures_json(const RunFigures& figures) {
  return {{"cycles", figures.cycles}, {"seconds", figures.seconds}, {"joules", figures.joules}};
}

/// A varied run's figures, or why there are none.
std::string run_varied(const SweepPoint& point, const PointRecording* recording, PointMode mode) {
  try {
    return json_text(figures_json(figures_of(Json::parse(run_point(point, recording, mode))["statistics"])));
  } catch (const std::exception& error) {
    return json_text({{"error", std::string(error.what()).substr(0, std::string(error.what()).find('\n'))}});
  }
}

/// None of what cannot be replayed: a board of several arrays, firmware with several threads.
std::optional<PointRecording> try_to_record(const SweepPoint& point) {
  if (!can_be_replayed(point)) return std::nullopt;
  try {
    return record_point(point);
  } catch (const std::exception&) {
    return std::nullopt;  // run in full, the point says for itself what is wrong with it
  }
}

}  // namespace

Sensitivity measure_sensitivity(const SweepPoint& point, Variations variations, double share, int jobs,
                                const std::function<void(double share)>& progress) {
  const std::optional<PointRecording> recording = try_to_record(point);
  const auto mode_of = [&](bool changes_requests) {
    return recording && !changes_requests ? PointMode::replay : PointMode::full;
  };
  const PointRecording* const recorded = recording ? &*recording : nullptr;
  std::vector<std::function<std::string()>> work = {
      [&] { return run_point(point, recorded, mode_of(false)); }};
  for (const Variation& variation : variations.list)
    work.emplace_back(
        [&, varied = on_chip(point, variation.chip), mode = mode_of(variation.changes_requests)] {
          return run_varied(varied, recorded, mode);
        });
  const std::vector<std::string> results =
      run_in_processes(work, jobs, [&](int finished) { progress(double(finished) / double(work.size())); });
  Sensitivity sensitivity;
  sensitivity.statistics = std::make_shared<const Json>(Json::parse(results[0])["statistics"]);
  sensitivity.base = figures_of(*sensitivity.statistics);
  sensitivity.left_out = std::move(variations.left_out);
  sensitivity.share = share;
  for (std::size_t i = 0; i < variations.list.size(); ++i) {
    const Json result = Json::parse(results[i + 1]);
    Variation& variation = variations.list[i];
    sensitivity.replayed += mode_of(variation.changes_requests) == PointMode::replay ? 1 : 0;
    if (result.contains("error"))
      sensitivity.runs.push_back({std::move(variation), {}, result["error"]});
    else
      sensitivity.runs.push_back(
          {std::move(variation), {result["cycles"], result["seconds"], result["joules"]}, ""});
  }
  return sensitivity;
}

}  // namespace testbench
