#include "testbench/sensitivity/run_file.hpp"

#include <nlohmann/json.hpp>

#include "firmware/path_tracer/program/program_options.hpp"
#include "testbench/plug_in/plug_in_settings.hpp"
#include "testbench/statistics/statistics_file.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;

class SettingsOfRun {
 public:
  SettingsOfRun(const Json& statistics, const std::string& origin) : run_(statistics), origin_(origin) {
    if (run_["timing"] != "none") add("timing", run_["timing"]);
    add_chip();
    run_["format"] == kRunStatisticsFormat ? add_plug_in() : add_render();
  }

  std::vector<Setting> settings;

 private:
  void add(const std::string& key, const Json& value) { settings.push_back({key, value_of(value), origin_}); }

  void add_chip() {
    for (const auto& [key, value] : flatten(run_["chip_config"]))
      if (model::find_parameter(key) != nullptr) add(key, value);
  }

  void add_render() {
    if (run_.contains("importance"))
      throw InputError(origin_ + ": importance: found '" + value_of(run_["importance"]) +
                       "'; allowed: a run without importance map");
    add("scene", run_["scene"]);
    add("size", value_of(run_["width"]) + "x" + value_of(run_["height"]));
    for (const auto& [name, value] : run_["firmware"].items())
      if (is_used(name)) add(name == "samples" ? name : "firmware." + name, value);
  }

  /// Options of a tree say nothing about a run without one.
  bool is_used(const std::string& name) const {
    const path_tracer::ProgramOption* const option = path_tracer::find_option(name);
    return option == nullptr || name == "traversal" || option->group != path_tracer::OptionGroup::tree ||
           run_["firmware"]["traversal"] != path_tracer::name_of(path_tracer::Traversal::brute_force);
  }

  void add_plug_in() {
    add(kFirmwareKey, run_["firmware"]["name"]);
    for (const auto& [name, value] : run_["firmware"]["options"].items()) add(kOptionPrefix + name, value);
  }

  const Json& run_;
  const std::string& origin_;
};

}  // namespace

std::vector<Setting> settings_of_run(const Json& statistics, const std::string& origin) {
  return SettingsOfRun(statistics, origin).settings;
}

}  // namespace testbench
