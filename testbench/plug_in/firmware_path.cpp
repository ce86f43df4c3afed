#include "testbench/plug_in/firmware_path.hpp"

#include <algorithm>
#include <filesystem>

#include "testbench/system/error.hpp"
#include "testbench/system/nearest_name.hpp"

namespace testbench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPrefix = "lib";
constexpr const char* kSuffix = ".so";

std::vector<fs::path> folders() {
  std::error_code ignored;  // without /proc, no firmware is found
  const fs::path beside = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  return {beside / "lib/csx600", beside.parent_path() / "lib/csx600"};
}

}  // namespace

bool is_firmware_file(const std::string& name) {
  return name.find('/') != std::string::npos || fs::path(name).extension() == kSuffix;
}

std::string firmware_name(const std::string& file) {
  const fs::path path = file;
  const std::string stem = path.stem();
  return path.extension() == kSuffix && stem.rfind(kPrefix, 0) == 0 ? stem.substr(3) : "";
}

std::vector<std::string> installed_firmwares() {
  std::vector<std::string> names;
  for (const fs::path& folder : folders()) {
    std::error_code ignored;  // a folder that is not there has no firmware
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored))
      if (const std::string name = firmware_name(entry.path()); !name.empty()) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

std::string firmware_path(const std::string& name) {
  if (is_firmware_file(name)) return name;
  for (const fs::path& folder : folders()) {
    const fs::path file = folder / (kPrefix + name + kSuffix);
    std::error_code ignored;  // then it is not this one
    if (fs::is_regular_file(file, ignored)) return file.lexically_normal();
  }
  const std::vector<std::string> names = installed_firmwares();
  const std::string nearest = nearest_name(name, names);
  std::string allowed;
  for (const std::string& known : names) allowed += ", " + known;
  throw InputError("firmware: found '" + name + "', allowed is the file of a shared library" +
                   (names.empty() ? ", with a slash or .so in its name" : " or one of" + allowed.substr(1)) +
                   (nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
}

}  // namespace testbench
