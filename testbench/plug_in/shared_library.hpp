#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "firmware/cn/simd/level.hpp"
#include "firmware/plug_in/entry.hpp"

namespace testbench {

/// A plug-in in memory. It stays there until the process ends, because statistics name its kernels.
class SharedLibrary {
 public:
  /// @param name a path, or the name of an installed firmware (firmware_path()). Throws InputError for what
  /// is no shared library, lacks the symbol of a plug-in, or was built with other headers than this program.
  explicit SharedLibrary(const std::string& name);

  const std::string& path() const { return path_; }
  /// Names this build of the plug-in: a digest of its file.
  const std::string& build() const { return build_; }

  /// The widest level that the plug-in has and this machine executes, or the level `wanted`. Throws
  /// InputError if there is none.
  cn::Level choose_level(std::optional<cn::Level> wanted) const;

  /// Throws InputError for a firmware that declares two options or two counters of one name.
  std::unique_ptr<plug_in::Firmware> make(cn::Level level) const;
  /// The same with kernels that report their SRAM accesses.
  std::unique_ptr<plug_in::Firmware> make_observed() const;

 private:
  std::string path_;
  std::string build_;
  const plug_in::Entry* entry_;
};

/// How options are called where their values are found.
struct OptionSpelling {
  std::string origin;  ///< "saxpy: " or "sweep.toml:3: "
  std::string prefix;  ///< "--" or "option."
};

/// Gives an option its value. Throws InputError, one line that names the option, for an unknown option and
/// for a value that is not allowed.
/// @param value "" if there is none
void set_option(plug_in::Firmware& firmware, const std::string& option, const std::string& value,
                const OptionSpelling& spelling);

/// Gives options their values: "--blocks=8" or "--blocks 8". Throws InputError as set_option() does, and for
/// an option that is there twice.
void set_options(plug_in::Firmware& firmware, const std::vector<std::string>& words);

/// A line for each option: name, range, default, meaning.
std::string describe_options(const plug_in::Firmware& firmware);
/// A line for each counter of the firmware's own, as describe_counters() has them of the chip's.
std::string describe_counters(const plug_in::Firmware& firmware);

}  // namespace testbench
