#include "testbench/sweep/point_work.hpp"

#include <nlohmann/json.hpp>

#include "testbench/statistics/counters.hpp"
#include "testbench/statistics/json_file.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/processes.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;

Json done_point(const SweepPoint& point, const RenderResult& result, const char* how) {
  Json statistics = render_statistics(point.request, result);
  statistics.erase(kSimulatorSection);
  return {{"status", "done"},
          {"how", how},
          {"audited", false},
          {"simulator_cpu_seconds", result.cpu_seconds},
          {"statistics", std::move(statistics)}};
}

std::string in_full(const SweepPoint& point) {
  return json_text(done_point(point, render_on_chip(*point.scene, point.request.options), "full"));
}

std::string replayed(const SweepPoint& point, const Recording& recording) {
  return json_text(done_point(point, replay_on_chip(recording, point.request.options), "replayed"));
}

std::string audited(const SweepPoint& point, const Recording& recording) {
  const std::vector<std::string> both =
      run_in_processes({[&] { return replayed(point, recording); }, [&] { return in_full(point); }}, 1);
  Json replay = Json::parse(both[0]);
  const std::string difference = first_difference(replay["statistics"], Json::parse(both[1])["statistics"]);
  if (!difference.empty()) throw RunError("audit: replayed and full run differ: " + difference);
  replay["audited"] = true;
  return json_text(replay);
}

}  // namespace

std::string run_point(const SweepPoint& point, const Recording* recording, PointMode mode) {
  if (mode == PointMode::full) return in_full(point);
  return mode == PointMode::replay ? replayed(point, *recording) : audited(point, *recording);
}

Json failed_point(const std::string& message) {
  return {{"status", "failed"}, {"error", message.substr(0, message.find('\n'))}};
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
