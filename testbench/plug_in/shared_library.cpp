#include "testbench/plug_in/shared_library.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <set>

#include "testbench/files/input_file.hpp"
#include "testbench/plug_in/firmware_path.hpp"
#include "testbench/system/crash_guard.hpp"
#include "testbench/system/digest.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/message_text.hpp"
#include "testbench/system/nearest_name.hpp"

namespace testbench {
namespace {

constexpr cn::Level kLevels[] = {cn::Level::x86_64_v2, cn::Level::x86_64_v3, cn::Level::x86_64_v4};

const void* load_entry(const std::string& path) {
  if (!std::filesystem::is_regular_file(path))
    throw InputError("firmware: found '" + path + "', allowed is the file of a shared library");
  constexpr int kWrongInput = 2;
  const std::string crash_message = message_line(
      "firmware: found '" + path + "', which crashes as it is loaded; allowed is a library that is whole");
  const CrashGuard guard(crash_message, kWrongInput);
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

/// Throws InputError for a name that is there twice.
template <class Declared>
void require_distinct(const std::string& path, const char* what, const std::vector<Declared*>& declared) {
  std::set<std::string> names;
  for (const Declared* const one : declared)
    if (!names.insert(one->name()).second)
      throw InputError("firmware: found '" + path + "', which declares the " + what + " '" + one->name() +
                       "' twice; allowed is once");
}

std::unique_ptr<plug_in::Firmware> checked(const std::string& path,
                                           std::unique_ptr<plug_in::Firmware> firmware) {
  require_distinct(path, "option", firmware->options());
  require_distinct(path, "counter", firmware->counters());
  return firmware;
}

[[noreturn]] void refuse_option(const plug_in::Firmware& firmware, const std::string& option,
                                const OptionSpelling& spelling) {
  std::vector<std::string> names;
  std::string allowed;
  for (const plug_in::OptionBase* const known : firmware.options()) {
    names.push_back(spelling.prefix + known->name());
    allowed += (allowed.empty() ? "" : ", ") + names.back();
  }
  const std::string nearest = nearest_name(spelling.prefix + option, names);
  throw InputError(spelling.origin + "found '" + spelling.prefix + option + "', allowed is " +
                   (allowed.empty() ? "no option" : allowed) +
                   (nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
}

}  // namespace

SharedLibrary::SharedLibrary(const std::string& name) : path_(firmware_path(name)) {
  const void* const entry = load_entry(path_);
  require_version(path_, entry);
  entry_ = static_cast<const plug_in::Entry*>(entry);
  build_ = sha256(read_input_file(path_, "the file of a shared library"));
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
  return checked(path_, entry_->at_level[std::size_t(level)]());
}

std::unique_ptr<plug_in::Firmware> SharedLibrary::make_observed() const {
  if (entry_->observed == nullptr)
    throw InputError("--check-hazards: found '" + path_ +
                     "' without observed kernels; allowed is a library that csx600_add_firmware() built");
  return checked(path_, entry_->observed());
}

void set_option(plug_in::Firmware& firmware, const std::string& option, const std::string& value,
                const OptionSpelling& spelling) {
  const auto has_name = [&](const plug_in::OptionBase* known) { return known->name() == option; };
  const auto found = std::find_if(firmware.options().begin(), firmware.options().end(), has_name);
  if (found == firmware.options().end()) refuse_option(firmware, option, spelling);
  if ((*found)->set(value)) return;
  throw InputError(spelling.origin + spelling.prefix + option + ": found " +
                   (value.empty() ? "no value" : "'" + value + "'") + ", allowed is " +
                   (*found)->allowed_text());
}

void set_options(plug_in::Firmware& firmware, const std::vector<std::string>& words) {
  const OptionSpelling spelling{firmware.name() + ": ", "--"};
  std::set<std::string> seen;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string& word = words[i];
    if (word.size() < 3 || word.rfind("--", 0) != 0)
      throw InputError(spelling.origin + "found '" + word + "', allowed is --name value or --name=value");
    const std::size_t equals = word.find('=');
    const std::string option = word.substr(2, equals == std::string::npos ? equals : equals - 2);
    if (!seen.insert(option).second)
      throw InputError(spelling.origin + "--" + option + ": found twice, allowed is once");
    std::string value;
    if (equals != std::string::npos) {
      value = word.substr(equals + 1);
    } else if (i + 1 < words.size()) {
      value = words[++i];
    }
    set_option(firmware, option, value, spelling);
  }
}

std::string describe_options(const plug_in::Firmware& firmware) {
  std::string text = firmware.name() + ": " + firmware.meaning() + "\n";
  for (const plug_in::OptionBase* const option : firmware.options())
    text += "  --" + option->name() + " " + option->allowed_text() + " [" + option->value_text() + "]  " +
            option->meaning() + "\n";
  return text;
}

std::string describe_counters(const plug_in::Firmware& firmware) {
  std::string text;
  for (const plug_in::Counter* const counter : firmware.counters())
    text +=
        "firmware.counters." + counter->name() + "  " + counter->unit() + "  " + counter->meaning() + "\n";
  return text;
}

}  // namespace testbench
