#pragma once

#include <functional>
#include <string>
#include <vector>

#include "model/config/chip_parameters.hpp"
#include "testbench/run/render.hpp"

namespace testbench {

/// One key of a run and the value that it is given.
struct Setting {
  std::string key;
  std::string value;
  std::string origin;  ///< "sweep.toml:7"
};

/// Everything about a run that a key can set.
struct RunSettings {
  std::string scene;
  std::string chip = "csx600";  ///< preset or .toml file
  std::string size;             ///< "WIDTHxHEIGHT"; "" for the scene's
  RenderOptions options;        ///< its chip is `chip` with the chip's keys
};

/// A key that is not one of the chip's: its name, its values and its effect.
struct RunParameter {
  std::string key;
  std::string allowed;
  model::Effect effect;
  /// Returns false, and changes no setting, for a value that is not allowed.
  std::function<bool(RunSettings&, const std::string& value)> write;
  std::function<std::string(const RunSettings&)> read;
};

/// scene, chip, size, samples, timing and "firmware." with each option of the firmware's table
/// (program_options.hpp). How many blocks are buffered (firmware.n, firmware.buffer) does not change the
/// image, but the order in which the firmware makes its requests.
const std::vector<RunParameter>& run_parameter_table();

/// nullptr for an unknown key.
const RunParameter* find_run_parameter(const std::string& key);

/// Whether a key names a parameter of the run or of the chip.
bool is_setting(const std::string& key);

/// Throws InputError for an unknown key and for a value that its parameter does not take.
void require_allowed(const Setting& setting);

/// A run with the best sampling and these settings, in any order: the chip's own keys change the chip that
/// `chip` names. Throws InputError for what require_allowed() refuses, and for values that do not fit each
/// other.
RunSettings make_settings(const std::vector<Setting>& settings);

/// model::load_chip() with the limits of input files: a regular file (FIFOs and devices may never end), not
/// too large, not nested too deep. Throws InputError for those and model::ConfigError.
model::ChipConfig load_chip(const std::string& preset_or_file);

/// The value of every key; chip and firmware.
std::string value_of(const RunSettings& settings, const std::string& key);

/// Two runs with the same text ask the same of their machines (Effect::stream).
std::string stream_inputs(const RunSettings& settings);

/// Two runs with the same text are the same run; the scene's files are not looked at.
std::string all_inputs(const RunSettings& settings);

}  // namespace testbench
