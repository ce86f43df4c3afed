#pragma once

#include <dlfcn.h>
#include <algorithm>
#include <cstring>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>

#include "firmware/plug_in/entry.hpp"

namespace examples {

/// A firmware that csx600_add_firmware() has built, for the widest x86-64 level that this machine executes.
/// Throws std::runtime_error, one line, for what is none or was built with another version of the package.
inline std::unique_ptr<plug_in::Firmware> load_plug_in(const std::string& file) {
  void* const library = dlopen(std::filesystem::absolute(file).c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) throw std::runtime_error(file + ": " + dlerror());
  const auto* const entry = static_cast<const plug_in::Entry*>(dlsym(library, plug_in::kEntrySymbol));
  if (entry == nullptr) throw std::runtime_error(file + ": found no symbol " + plug_in::kEntrySymbol);
  if (std::strncmp(entry->version, plug_in::kInterfaceVersion, plug_in::kVersionBytes) != 0)
    throw std::runtime_error(file + ": found version " +
                             std::string(entry->version, strnlen(entry->version, plug_in::kVersionBytes)) +
                             "; allowed: " + plug_in::kInterfaceVersion);
  const bool executes[] = {__builtin_cpu_supports("x86-64-v2") != 0, __builtin_cpu_supports("x86-64-v3") != 0,
                           __builtin_cpu_supports("x86-64-v4") != 0};
  for (std::size_t level = std::size(executes); level-- > 0;)
    if (executes[level] && entry->at_level[level] != nullptr) return entry->at_level[level]();
  throw std::runtime_error(file + ": found no level that this machine executes");
}

/// Gives an option its value, written "--blocks=8". Throws std::runtime_error for anything else.
inline void set_option(plug_in::Firmware& firmware, const std::string& word) {
  const std::size_t equals = word.find('=');
  for (plug_in::OptionBase* const option : firmware.options()) {
    if (equals == std::string::npos || "--" + option->name() != word.substr(0, equals)) continue;
    if (option->set(word.substr(equals + 1))) return;
    throw std::runtime_error(word + ": allowed: " + option->allowed_text());
  }
  throw std::runtime_error(firmware.name() + ": found '" + word +
                           "'; allowed: --OPTION=VALUE of its options");
}

}  // namespace examples
