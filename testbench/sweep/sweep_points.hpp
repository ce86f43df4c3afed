#pragma once

#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
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
  std::string excluded;                      ///< the constraint over its parameters that it does not meet
  std::map<std::string, double> parameters;  ///< those that the sweep's expressions name
};

/// What a sweep says of its points beside their values.
struct SweepExpressions {
  std::vector<NamedExpression> constraints;
  std::vector<NamedExpression> derived;
};

/// The value of an expression, whose names stand for parameters of a point or for its results; none where a
/// result that it names is missing.
std::optional<double> value_of(const Expression& expression, const SweepPoint& point,
                               const nlohmann::ordered_json& results);

/// Whether a constraint with this value is met: it is neither 0 nor undefined.
bool is_met(double value);

/// What a table says of a point that does not meet a constraint.
std::string unmet_text(const NamedExpression& constraint);

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
  const SweepExpressions& expressions() const { return expressions_; }
  /// Whether an expression may name it as a value that each point has before it runs.
  bool is_parameter(const std::string& key) const;
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
  double parameter_of(const SweepPoint& point, const std::string& key, const std::vector<Setting>& settings,
                      const RunSettings* render) const;
  /// Reads the parameters that the expressions name, and says whether the point is to be left out.
  void constrain(SweepPoint& point, const std::vector<Setting>& settings, const RunSettings* render) const;
  /// @param given options of the firmware that the sweep sets; the others are chosen
  static void set_run(SweepPoint& point, RunSettings run, LoadedScene& loaded, const GivenOptions& given);
  static void set_run(SweepPoint& point, PlugInSettings&& run);
  LoadedScene& scene_of(const RunSettings& run);

  std::vector<std::string> keys_;
  std::vector<std::vector<std::string>> axes_;
  std::vector<Setting> base_;
  SweepExpressions expressions_;
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
