#include "testbench/plug_in/plug_in_settings.hpp"

#include "testbench/system/error.hpp"

namespace testbench {
namespace {

bool is_option(const std::string& key) {
  return key.rfind(kOptionPrefix, 0) == 0;
}

void set_option_of(plug_in::Firmware& firmware, const Setting& setting) {
  const std::string option = setting.key.substr(std::string(kOptionPrefix).size());
  set_option(firmware, option, setting.value, {setting.origin + ": ", kOptionPrefix});
}

std::unique_ptr<plug_in::Firmware> make(const SharedLibrary& library) {
  return library.make(library.choose_level(std::nullopt));
}

/// Throws InputError for what only a render has.
void require_key_of_plug_in(const Setting& setting) {
  const bool is_of_render =
      find_run_parameter(setting.key) != nullptr && setting.key != "chip" && setting.key != "timing";
  if (is_of_render)
    throw InputError(setting.origin + ": found '" + setting.key +
                     "' beside a firmware; allowed: chip, timing, option. with an option of the firmware, "
                     "and the keys listed by 'csx600 params'");
}

}  // namespace

bool is_plug_in_key(const std::string& key) {
  return key == kFirmwareKey || is_option(key);
}

std::unique_ptr<plug_in::Firmware> PlugInSettings::make_firmware() const {
  std::unique_ptr<plug_in::Firmware> firmware = make(*library);
  for (const Setting& setting : option_settings) set_option_of(*firmware, setting);
  return firmware;
}

void require_option(const SharedLibrary& library, const Setting& setting) {
  set_option_of(*make(library), setting);
}

PlugInSettings make_plug_in_settings(const std::shared_ptr<const SharedLibrary>& library,
                                     const std::vector<Setting>& settings) {
  PlugInSettings made;
  made.library = library;
  std::vector<Setting> of_chip;
  for (const Setting& setting : settings) {
    if (is_option(setting.key)) {
      made.option_settings.push_back(setting);
    } else if (setting.key != kFirmwareKey) {
      require_key_of_plug_in(setting);
      of_chip.push_back(setting);
    }
  }
  const RunSettings run = make_settings(of_chip);
  made.chip = run.chip;
  made.options.chip = run.options.chip;
  made.options.timing = run.options.timing;
  std::string of_firmware = "firmware = " + library->build() + "\n";
  const std::unique_ptr<plug_in::Firmware> firmware = made.make_firmware();
  for (const plug_in::OptionBase* const option : firmware->options())
    of_firmware += kOptionPrefix + option->name() + " = " + option->value_text() + "\n";
  made.stream_inputs = of_firmware + stream_inputs(run);
  made.all_inputs = of_firmware + all_inputs(run);
  return made;
}

}  // namespace testbench
