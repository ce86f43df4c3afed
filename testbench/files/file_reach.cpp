#include "testbench/files/file_reach.hpp"

#include <algorithm>

#include "testbench/system/error.hpp"

namespace testbench {

FileReach::FileReach(const std::filesystem::path& folder, bool is_outside_allowed)
    : is_outside_allowed_(is_outside_allowed) {
  std::error_code error;
  folder_ = std::filesystem::weakly_canonical(std::filesystem::absolute(folder, error), error);
}

bool FileReach::holds(const std::filesystem::path& file, const std::string& named_by) const {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) return false;
  if (!is_outside_allowed_) {
    const auto real = std::filesystem::weakly_canonical(std::filesystem::absolute(file, error), error);
    const auto [end_of_folder, unused] =
        std::mismatch(folder_.begin(), folder_.end(), real.begin(), real.end());
    if (error || end_of_folder != folder_.end())
      throw InputError(named_by + ": found the file " + file.string() +
                       " outside the scene's folder; allowed: files below it, or all with --allow-outside");
  }
  if (!std::filesystem::is_regular_file(status))
    throw InputError(named_by + ": found " + file.string() +
                     ", which cannot be read; allowed: a regular file");
  remember(file);
  return true;
}

void FileReach::require(const std::filesystem::path& file, const std::string& named_by) const {
  if (!holds(file, named_by))
    throw InputError(named_by + ": found no file " + file.string() +
                     ", it cannot be read; allowed: a readable file");
}

}  // namespace testbench
