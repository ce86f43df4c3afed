#pragma once

#include <memory>
#include <string>
#include <vector>

#include "testbench/plug_in/plug_in_run.hpp"
#include "testbench/plug_in/shared_library.hpp"
#include "testbench/run/run_settings.hpp"

namespace testbench {

/// The keys by which sweeps and golden grids name a firmware outside this tree and its options.
inline constexpr const char* kFirmwareKey = "firmware";
inline constexpr const char* kOptionPrefix = "option.";

/// Whether a key is "firmware" or begins with "option.".
bool is_plug_in_key(const std::string& key);

/// A run of a plug-in as settings say it.
struct PlugInSettings {
  std::shared_ptr<const SharedLibrary> library;
  std::vector<Setting> option_settings;
  std::string chip;  ///< preset or .toml file
  PlugInOptions options;
  std::string stream_inputs;  ///< two runs with the same text ask the same of their machines
  std::string all_inputs;     ///< two runs with the same text are the same run

  /// A firmware whose options have their values.
  std::unique_ptr<plug_in::Firmware> make_firmware() const;
};

/// Throws InputError for an option that the firmware does not have and a value that it does not allow.
void require_option(const SharedLibrary& library, const Setting& setting);

/// The firmware's options, the chip and its own keys, and the timing, in any order. Throws InputError as
/// make_settings() and require_option() do, and for keys of a render.
PlugInSettings make_plug_in_settings(const std::shared_ptr<const SharedLibrary>& library,
                                     const std::vector<Setting>& settings);

}  // namespace testbench
