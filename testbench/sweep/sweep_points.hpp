#pragma once

#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "testbench/plug_in/plug_in_settings.hpp"
#include "testbench/run/traversal_choice.hpp"
#include "testbench/statistics/render_report.hpp"
#include "testbench/sweep/sweep_file.hpp"

namespace testbench {

/// A render of a scene.
struct RenderPoint {
  RenderRequest request;
  const Scene* scene = nullptr;
};

/// One combination of the axes' values.
struct SweepPoint {
  std::vector<std::string> inputs;  ///< by key of the sweep
  std::string id;                   ///< digest of everything that decides its result
  std::string stream;               ///< digest of what decides the stream of calls; "" if there is none
  bool audited = false;             ///< replayed and run in full, and both must agree
  std::variant<RenderPoint, PlugInSettings> run;  ///< a firmware outside this tree is the alternative
  std::string error;                              ///< why it cannot run, if its values do not fit each other
};

/// All points of a sweep, with the scenes they render or the firmware that they run.
class Sweep {
 public:
  /// @param overrides take the place of the file's base values
  /// @param is_outside_allowed see load_scene(). Throws InputError.
  Sweep(const SweepFile& file, const std::vector<Setting>& overrides, bool is_outside_allowed = false);

  const std::vector<std::string>& keys() const { return keys_; }
  const std::vector<std::vector<std::string>>& axes() const { return axes_; }  ///< their keys
  const std::vector<Setting>& base() const { return base_; }
  const std::vector<SweepPoint>& points() const { return points_; }
  /// Names the builds of the firmwares that the points run; "" of renders.
  std::string firmware_builds() const;
  /// Of every scene, by its path.
  const std::map<std::string, Notes>& notes() const { return notes_; }

 private:
  struct LoadedScene {
    Scene scene;
    std::string digest;
    std::map<path_tracer::LightSampling, std::shared_ptr<const LightSurvey>> light_surveys = {};
  };

  /// Loads the firmwares that the file names and checks every value of their options.
  void load_libraries(const SweepFile& file);
  SweepPoint make_point(const SweepFile& file, std::uint64_t number);
  /// @param given options of the firmware that the sweep sets; the others are chosen
  static void set_run(SweepPoint& point, RunSettings run, LoadedScene& loaded, const GivenOptions& given);
  static void set_run(SweepPoint& point, PlugInSettings&& run);
  LoadedScene& scene_of(const RunSettings& run);

  std::vector<std::string> keys_;
  std::vector<std::vector<std::string>> axes_;
  std::vector<Setting> base_;
  bool is_outside_allowed_;
  std::map<std::string, std::unique_ptr<LoadedScene>> scenes_;             ///< by path and size
  std::map<std::string, std::shared_ptr<const SharedLibrary>> libraries_;  ///< by the file's name for them
  std::map<std::string, Notes> notes_;
  std::vector<SweepPoint> points_;
};

/// The chip that a point runs on.
const model::ChipConfig& chip_of(const SweepPoint& point);

/// Whether a recording of the point tells its time: a recording is the stream of one array.
bool can_be_replayed(const SweepPoint& point);

/// "firmware.n=2, pio.setup_cycles=150"
std::string describe_point(const Sweep& sweep, const SweepPoint& point);

}  // namespace testbench
