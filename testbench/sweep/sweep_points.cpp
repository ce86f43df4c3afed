#include "testbench/sweep/sweep_points.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>

#include "testbench/film/film_size.hpp"
#include "testbench/mono_image/mono_image.hpp"
#include "testbench/run/program_choice.hpp"
#include "testbench/scene_file/scene_file.hpp"
#include "testbench/system/digest.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

constexpr std::size_t kIdDigits = 32;

std::string short_digest(const std::string& text) {
  return sha256(text).substr(0, kIdDigits);
}

/// Decided by the point and the seed alone: whoever runs it, and however often, audits the same points.
bool is_audited(const std::string& id, const SweepFile& file) {
  const std::string digest = sha256(id + std::to_string(file.audit_seed)).substr(0, 13);
  const double share = double(std::strtoull(digest.c_str(), nullptr, 16)) / double(std::uint64_t{1} << 52);
  return share < file.audit_share;
}

/// What the firmware sees of a scene: the host's image of it, for a firmware that all scenes share, and light
/// from outside, which the layout holds. All textures are in it, whatever a point's firmware does with them.
std::string scene_digest(const Scene& scene) {
  path_tracer::ProgramConfig program;
  program.folds_constant_textures = false;
  const MonoImage image = make_normal_mono_image(scene, cn::kStripLanes, program);
  std::string seen(reinterpret_cast<const char*>(image.bytes.data()), image.bytes.size());
  if (image.layout.features.environment) {
    const cn::vec3<double>& outside = image.layout.environment;
    seen.append(reinterpret_cast<const char*>(&outside), sizeof(outside));
  }
  return sha256(seen);
}

/// A flag is 0 or 1; none for another text.
std::optional<double> number_from(const std::string& text) {
  if (text == "true" || text == "false") return text == "true";
  std::istringstream stream(text);
  double number = 0;
  return stream >> number && stream.eof() ? std::optional(number) : std::nullopt;
}

/// The firmware's options that the settings name.
GivenOptions given_options(const std::vector<Setting>& settings) {
  const std::string prefix = "firmware.";
  GivenOptions given;
  for (const Setting& setting : settings)
    if (setting.key.rfind(prefix, 0) == 0) given.insert(setting.key.substr(prefix.size()));
  return given;
}

}  // namespace

Sweep::Sweep(const SweepFile& file, const std::vector<Setting>& overrides, bool is_outside_allowed)
    : keys_(file.keys()),
      base_(file.base),
      expressions_{file.constraints, file.derived},
      is_outside_allowed_(is_outside_allowed) {
  for (const SweepAxis& axis : file.axes) axes_.push_back(axis.keys);
  for (const Setting& setting : overrides) {
    require_setting(setting);
    if (std::find(keys_.begin(), keys_.end(), setting.key) != keys_.end())
      throw InputError(setting.origin + ": found '" + setting.key +
                       "', which is on an axis; allowed: other keys");
    const auto is_same = [&](const Setting& other) { return other.key == setting.key; };
    base_.erase(std::remove_if(base_.begin(), base_.end(), is_same), base_.end());
    base_.push_back(setting);
  }
  load_libraries(file);
  for (std::uint64_t number = 0; number < file.points(); ++number)
    points_.push_back(make_point(file, number));
  const auto cannot_run = [](const SweepPoint& point) { return !point.error.empty(); };
  if (std::all_of(points_.begin(), points_.end(), cannot_run)) throw InputError(points_.front().error);
  const auto is_excluded = [](const SweepPoint& point) { return !point.excluded.empty(); };
  if (std::all_of(points_.begin(), points_.end(), is_excluded))
    throw InputError(file.path + ": found that no point meets the constraints (the first: " +
                     points_.front().excluded + "); allowed: constraints that leave a point");
}

bool Sweep::is_parameter(const std::string& key) const {
  const auto has_key = [&](const Setting& setting) { return setting.key == key; };
  return model::find_parameter(key) != nullptr || std::find(keys_.begin(), keys_.end(), key) != keys_.end() ||
         std::any_of(base_.begin(), base_.end(), has_key);
}

double Sweep::parameter_of(const SweepPoint& point, const std::string& key,
                           const std::vector<Setting>& settings, const RunSettings* render) const {
  const auto is_key = [&](const Setting& setting) { return setting.key == key; };
  const auto given = std::find_if(settings.rbegin(), settings.rend(), is_key);
  const std::string text = render != nullptr          ? testbench::value_of(*render, key)
                           : given != settings.rend() ? given->value
                                                      : model::parameter_text(chip_of(point), key);
  const std::optional<double> number = number_from(text);
  if (!number)
    throw InputError("found '" + key + "', which is '" + text + "'; allowed: parameters that are numbers");
  return *number;
}

void Sweep::constrain(SweepPoint& point, const std::vector<Setting>& settings,
                      const RunSettings* render) const {
  const auto read = [&](const NamedExpression& named) {
    try {
      for (const std::string& key : named.expression.names())
        if (is_parameter(key)) point.parameters[key] = parameter_of(point, key, settings, render);
    } catch (const InputError& error) {
      throw InputError(named.expression.origin() + ": " + error.what());
    }
  };
  for (const NamedExpression& derived : expressions_.derived) read(derived);
  for (const NamedExpression& constraint : expressions_.constraints) {
    read(constraint);
    const std::optional<double> value = testbench::value_of(constraint.expression, point, {});
    if (value && !is_met(*value) && point.excluded.empty()) point.excluded = unmet_text(constraint);
  }
}

SweepPoint Sweep::make_point(const SweepFile& file, std::uint64_t number) {
  SweepPoint point;
  std::vector<Setting> settings = base_;
  std::uint64_t rest = number;  // the last axis runs fastest
  std::uint64_t weight = file.points();
  for (const SweepAxis& axis : file.axes) {
    weight /= axis.steps.size();
    const std::vector<Setting>& step = axis.steps[rest / weight];
    rest %= weight;
    settings.insert(settings.end(), step.begin(), step.end());
    for (const Setting& setting : step) point.inputs.push_back(setting.value);
  }
  const auto names_firmware = [](const Setting& setting) { return setting.key == kFirmwareKey; };
  const auto firmware = std::find_if(settings.begin(), settings.end(), names_firmware);
  const auto fail = [&](const InputError& error) {
    point.error = error.what();
    std::string inputs;
    for (const Setting& setting : settings) inputs += setting.key + " = " + setting.value + "\n";
    point.id = short_digest(inputs);
    return point;
  };
  std::optional<RunSettings> render;
  try {
    if (firmware != settings.end())
      set_run(point, make_plug_in_settings(libraries_.at(firmware->value), settings));
    else
      render = make_settings(settings);
  } catch (const InputError& error) {
    return fail(error);
  }
  constrain(point, settings, render ? &*render : nullptr);
  if (!point.excluded.empty()) return point;
  if (render) {
    LoadedScene& scene = scene_of(*render);  // what it throws is of every point
    try {
      set_run(point, std::move(*render), scene, given_options(settings));
    } catch (const InputError& error) {
      return fail(error);
    }
  }
  point.audited = is_audited(point.id, file);
  return point;
}

void Sweep::set_run(SweepPoint& point, RunSettings run, LoadedScene& loaded, const GivenOptions& given) {
  RenderRequest request{run.scene, {}, false};
  request.traversal_reason = choose_program(loaded.scene, run.options.chip, given, run.options.program);
  const path_tracer::LightSampling sampling = run.options.program.light_sampling;
  std::shared_ptr<const LightSurvey>& survey = loaded.light_surveys[sampling];
  if (!survey) survey = std::make_shared<const LightSurvey>(make_normal_light_survey(loaded.scene, sampling));
  request.options = run.options;
  request.options.light_survey = survey;
  point.run = RenderPoint{request, &loaded.scene};
  point.id = short_digest(all_inputs(run) + loaded.digest);
  point.stream = short_digest(stream_inputs(run) + loaded.digest);
}

void Sweep::set_run(SweepPoint& point, PlugInSettings&& run) {
  point.id = short_digest(run.all_inputs);
  point.stream = short_digest(run.stream_inputs);
  point.run = std::move(run);
}

void Sweep::load_libraries(const SweepFile& file) {
  std::vector<Setting> settings = base_;
  for (const SweepAxis& axis : file.axes)
    for (const std::vector<Setting>& step : axis.steps)
      settings.insert(settings.end(), step.begin(), step.end());
  for (const Setting& setting : settings)
    if (setting.key == kFirmwareKey && libraries_.count(setting.value) == 0) {
      try {
        libraries_[setting.value] = std::make_shared<const SharedLibrary>(setting.value);
      } catch (const InputError& error) {
        throw InputError(setting.origin + ": " + error.what());
      }
    }
  for (const Setting& setting : settings) {
    if (!is_plug_in_key(setting.key) || setting.key == kFirmwareKey) continue;
    if (libraries_.empty())
      throw InputError(setting.origin + ": found '" + setting.key +
                       "' without a firmware; allowed beside firmware = \"libNAME.so\"");
    for (const auto& [name, library] : libraries_) require_option(*library, setting);
  }
}

std::string Sweep::firmware_builds() const {
  std::string builds;
  for (const auto& [name, library] : libraries_) builds += library->build();
  return builds;
}

Sweep::LoadedScene& Sweep::scene_of(const RunSettings& run) {
  std::unique_ptr<LoadedScene>& loaded = scenes_[run.scene + "\n" + run.size];
  if (!loaded) {
    if (run.scene.empty())
      throw InputError("scene: found none; allowed: a directory with a scene.toml, or a .toml file");
    loaded = std::make_unique<LoadedScene>();
    loaded->scene = load_scene(run.scene, is_outside_allowed_);
    notes_.emplace(run.scene, loaded->scene.notes);
    if (!run.size.empty()) loaded->scene.film = *parse_film_size(run.size);
    loaded->digest = scene_digest(loaded->scene);
  }
  return *loaded;
}

std::optional<double> value_of(const Expression& expression, const SweepPoint& point,
                               const nlohmann::ordered_json& results) {
  std::vector<double> values;
  for (const std::string& name : expression.names()) {
    if (const auto parameter = point.parameters.find(name); parameter != point.parameters.end())
      values.push_back(parameter->second);
    else if (const auto result = results.find(name); result != results.end() && result->is_number())
      values.push_back(result->get<double>());
    else
      return std::nullopt;
  }
  return expression.value(values);
}

bool is_met(double value) {
  return value != 0 && !std::isnan(value);
}

std::string unmet_text(const NamedExpression& constraint) {
  return "constraint " + constraint.name + " is not met: " + constraint.expression.text();
}

const model::ChipConfig& chip_of(const SweepPoint& point) {
  if (const auto* const render = std::get_if<RenderPoint>(&point.run)) return render->request.options.chip;
  return std::get<PlugInSettings>(point.run).options.chip;
}

bool can_be_replayed(const SweepPoint& point) {
  const model::ChipConfig& chip = chip_of(point);
  return chip.board.chips * chip.chip.arrays == 1 && chip.search_unit.units == 0;
}

std::string describe_point(const Sweep& sweep, const SweepPoint& point) {
  std::string text;
  for (std::size_t i = 0; i < point.inputs.size(); ++i)
    text += (i == 0 ? "" : ", ") + sweep.keys()[i] + "=" + point.inputs[i];
  return text.empty() ? "the only point" : text;
}

}  // namespace testbench
