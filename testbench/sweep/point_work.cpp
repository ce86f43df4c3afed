#include "testbench/sweep/point_work.hpp"

#include <nlohmann/json.hpp>

#include "testbench/statistics/counters.hpp"
#include "testbench/statistics/json_file.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/processes.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;

/// What a run of any kind leaves behind.
struct Outcome {
  Json statistics;
  double cpu_seconds;
};

Outcome outcome(const RenderPoint& point, const RenderResult& result) {
  Json statistics = render_statistics(point.request, result);
  statistics.erase(kSimulatorSection);
  return {std::move(statistics), result.cpu_seconds};
}

Outcome outcome(const PlugInSettings& point, const plug_in::Firmware& firmware, const PlugInResult& result) {
  return {plug_in_statistics(firmware, point.options, result), result.cpu_seconds};
}

Outcome run_in_full(const RenderPoint& point) {
  return outcome(point, render_on_chip(*point.scene, point.request.options));
}

Outcome run_in_full(const PlugInSettings& point) {
  const std::unique_ptr<plug_in::Firmware> firmware = point.make_firmware();
  const PlugInResult result = run_plug_in(*firmware, point.options);
  return outcome(point, *firmware, result);
}

Outcome replay(const RenderPoint& point, const Recording& recording) {
  return outcome(point, replay_on_chip(recording, point.request.options));
}

Outcome replay(const PlugInSettings& point, const PlugInRecording& recording) {
  return outcome(point, *recording.firmware, replay_plug_in(recording, point.options));
}

PointRecording record(const RenderPoint& point) {
  return record_render(*point.scene, point.request.options);
}

PointRecording record(const PlugInSettings& point) {
  return record_plug_in(point.make_firmware(), point.options);
}

std::string done_point(Outcome outcome, const char* how) {
  return json_text({{"status", "done"},
                    {"how", how},
                    {"audited", false},
                    {"simulator_cpu_seconds", outcome.cpu_seconds},
                    {"statistics", std::move(outcome.statistics)}});
}

std::string in_full(const SweepPoint& point) {
  return done_point(std::visit([](const auto& run) { return run_in_full(run); }, point.run), "full");
}

std::string replayed(const SweepPoint& point, const PointRecording& recording) {
  if (const auto* const render = std::get_if<RenderPoint>(&point.run))
    return done_point(replay(*render, std::get<Recording>(recording)), "replayed");
  return done_point(replay(std::get<PlugInSettings>(point.run), std::get<PlugInRecording>(recording)),
                    "replayed");
}

std::string audited(const SweepPoint& point, const PointRecording& recording) {
  const std::vector<std::string> both =
      run_in_processes({[&] { return replayed(point, recording); }, [&] { return in_full(point); }}, 1);
  Json replay = Json::parse(both[0]);
  const std::string difference = first_difference(replay["statistics"], Json::parse(both[1])["statistics"]);
  if (!difference.empty()) throw RunError("audit: replayed and full run differ: " + difference);
  replay["audited"] = true;
  return json_text(replay);
}

}  // namespace

PointRecording record_point(const SweepPoint& point) {
  return std::visit([](const auto& run) { return record(run); }, point.run);
}

std::string run_point(const SweepPoint& point, const PointRecording* recording, PointMode mode) {
  if (mode == PointMode::full) return in_full(point);
  return mode == PointMode::replay ? replayed(point, *recording) : audited(point, *recording);
}

Json failed_point(const std::string& message) {
  return {{"status", "failed"}, {"error", message}};
}

std::string first_difference(const Json& a, const Json& b) {
  const Json changes = Json::diff(a, b);
  if (changes.empty()) return "";
  const std::string path = changes[0]["path"];
  const Json::json_pointer pointer(path);
  const auto text = [&](const Json& json) {
    return json.contains(pointer) ? json_text(json[pointer]) : "missing";
  };
  return path + ": " + text(a) + ", " + text(b);
}

}  // namespace testbench
