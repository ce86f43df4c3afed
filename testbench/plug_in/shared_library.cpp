#include "testbench/plug_in/shared_library.hpp"

#include <dlfcn.h>

#include <cstring>
#include <filesystem>

#include "testbench/system/error.hpp"

namespace testbench {
namespace {

constexpr cn::Level kLevels[] = {cn::Level::x86_64_v2, cn::Level::x86_64_v3, cn::Level::x86_64_v4};

const void* load_entry(const std::string& path) {
  if (!std::filesystem::is_regular_file(path))
    throw InputError("firmware: found '" + path + "', allowed is the file of a shared library");
  void* const library = dlopen(std::filesystem::absolute(path).c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr)
    throw InputError("firmware: found '" + path + "', which does not load as a shared library: " + dlerror());
  const void* const entry = dlsym(library, plug_in::kEntrySymbol);
  if (entry == nullptr)
    throw InputError("firmware: found '" + path + "', which has no symbol " + plug_in::kEntrySymbol +
                     "; allowed is a library that csx600_add_firmware() built");
  return entry;
}

void require_version(const std::string& path, const void* entry) {
  const auto* const version = static_cast<const char*>(entry);
  const std::string found(version, strnlen(version, plug_in::kVersionBytes));
  if (found == plug_in::kInterfaceVersion) return;
  throw InputError("firmware: found '" + path + "' of version " + found + ", allowed is " +
                   plug_in::kInterfaceVersion + ": build it again with the package of this program");
}

plug_in::OptionBase& find_option(plug_in::Firmware& firmware, const std::string& word,
                                 const std::string& name) {
  std::string names;
  for (plug_in::OptionBase* const option : firmware.options()) {
    if ("--" + option->name() == name) return *option;
    names += (names.empty() ? "--" : ", --") + option->name();
  }
  throw InputError(firmware.name() + ": found '" + word + "', allowed is " +
                   (names.empty() ? "no option" : names));
}

}  // namespace

SharedLibrary::SharedLibrary(const std::string& path) : path_(path) {
  const void* const entry = load_entry(path);
  require_version(path, entry);
  entry_ = static_cast<const plug_in::Entry*>(entry);
}

cn::Level SharedLibrary::choose_level(std::optional<cn::Level> wanted) const {
  std::optional<cn::Level> widest;
  std::string names;
  for (const cn::Level level : kLevels) {
    if (entry_->at_level[std::size_t(level)] == nullptr || !cn::processor_executes(level)) continue;
    if (wanted == level) return level;
    widest = level;
    names += (names.empty() ? "" : ", ") + cn::name_of(level);
  }
  const std::string allowed = names.empty() ? "'" + path_ + "' has no level that this machine executes"
                                            : "'" + path_ + "' has on this machine " + names;
  if (wanted) throw InputError("--level: found " + cn::name_of(*wanted) + ", " + allowed);
  if (!widest)
    throw InputError("firmware: " + allowed + "; allowed is one built with CSX600_FIRMWARE_LEVELS=v2");
  return *widest;
}

std::unique_ptr<plug_in::Firmware> SharedLibrary::make(cn::Level level) const {
  return entry_->at_level[std::size_t(level)]();
}

std::unique_ptr<plug_in::Firmware> SharedLibrary::make_observed() const {
  if (entry_->observed == nullptr)
    throw InputError("--check-hazards: found '" + path_ +
                     "' without observed kernels; allowed is a library that csx600_add_firmware() built");
  return entry_->observed();
}

void set_options(plug_in::Firmware& firmware, const std::vector<std::string>& words) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string& word = words[i];
    const std::size_t equals = word.find('=');
    const std::string name = word.substr(0, equals);
    plug_in::OptionBase& option = find_option(firmware, word, name);
    const auto refuse = [&](const std::string& found) {
      std::string message = name + ": found ";
      message += found + ", allowed is " + option.allowed_text();
      throw InputError(message);
    };
    if (equals == std::string::npos && i + 1 == words.size()) refuse("no value");
    const std::string value = equals == std::string::npos ? words[++i] : word.substr(equals + 1);
    if (!option.set(value)) refuse("'" + value + "'");
  }
}

std::string describe_options(const plug_in::Firmware& firmware) {
  std::string text = firmware.name() + ": " + firmware.meaning() + "\n";
  for (const plug_in::OptionBase* const option : firmware.options())
    text += "  --" + option->name() + " " + option->allowed_text() + " [" + option->value_text() + "]  " +
            option->meaning() + "\n";
  return text;
}

}  // namespace testbench
