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
  /// Throws InputError for what is no shared library, lacks the symbol of a plug-in, or was built with other
  /// headers than this program.
  explicit SharedLibrary(const std::string& path);

  /// The widest level that the plug-in has and this machine executes, or the level `wanted`. Throws
  /// InputError if there is none.
  cn::Level choose_level(std::optional<cn::Level> wanted) const;

  std::unique_ptr<plug_in::Firmware> make(cn::Level level) const;
  /// The same with kernels that report their SRAM accesses.
  std::unique_ptr<plug_in::Firmware> make_observed() const;

 private:
  std::string path_;
  const plug_in::Entry* entry_;
};

/// Gives options their values: "--blocks=8" or "--blocks 8". Throws InputError, one line that names the
/// option, for an unknown option and for a value that is not allowed.
void set_options(plug_in::Firmware& firmware, const std::vector<std::string>& words);

/// A line for each option: name, range, default, meaning.
std::string describe_options(const plug_in::Firmware& firmware);

}  // namespace testbench
