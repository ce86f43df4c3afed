#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "testbench/statistics/render_report.hpp"
#include "testbench/sweep/sweep_file.hpp"

namespace testbench {

/// One combination of the axes' values.
struct SweepPoint {
  std::vector<std::string> inputs;  ///< by key of the sweep
  std::string id;                   ///< digest of everything that decides its result
  std::string stream;               ///< digest of what decides the stream of calls; "" if there is none
  bool audited = false;             ///< replayed and run in full, and both must agree
  RenderRequest request;
  const Scene* scene = nullptr;
  std::string error;  ///< why it cannot run, if its values do not fit each other
};

/// All points of a sweep, with the scenes they render.
class Sweep {
 public:
  /// @param overrides take the place of the file's base values
  /// @param is_outside_allowed see load_scene(). Throws InputError.
  Sweep(const SweepFile& file, const std::vector<Setting>& overrides, bool is_outside_allowed = false);

  const std::vector<std::string>& keys() const { return keys_; }
  const std::vector<std::vector<std::string>>& axes() const { return axes_; }  ///< their keys
  const std::vector<Setting>& base() const { return base_; }
  const std::vector<SweepPoint>& points() const { return points_; }
  /// Of every scene, by its path.
  const std::map<std::string, Notes>& notes() const { return notes_; }

 private:
  struct LoadedScene {
    Scene scene;
    std::string digest;
    std::map<path_tracer::LightSampling, std::shared_ptr<const LightSurvey>> light_surveys = {};
  };

  SweepPoint make_point(const SweepFile& file, std::uint64_t number);
  LoadedScene& scene_of(const RunSettings& run);

  std::vector<std::string> keys_;
  std::vector<std::vector<std::string>> axes_;
  std::vector<Setting> base_;
  bool is_outside_allowed_;
  std::map<std::string, std::unique_ptr<LoadedScene>> scenes_;  ///< by path and size
  std::map<std::string, Notes> notes_;
  std::vector<SweepPoint> points_;
};

/// "firmware.n=2, pio.setup_cycles=150"
std::string describe_point(const Sweep& sweep, const SweepPoint& point);

}  // namespace testbench
