#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace testbench {

/// Which files a scene may read: those below its own folder, so that a scene from a stranger shows nothing
/// else of the machine. --allow-outside lifts the limit. Remembers, over all its copies, the files that were
/// asked for, so that no output takes the place of one.
class FileReach {
 public:
  /// @param folder the folder of the scene, or of a mesh file that is rendered without one
  explicit FileReach(const std::filesystem::path& folder, bool is_outside_allowed = false);

  /// Whether `file` exists. Throws InputError if it does but is no regular file (a FIFO or device could block
  /// or never end), or lies outside the folder, also by way of a symbolic link.
  /// @param named_by who names it, in the message: "scene.toml:3"
  bool holds(const std::filesystem::path& file, const std::string& named_by) const;

  /// Throws InputError unless holds(file).
  void require(const std::filesystem::path& file, const std::string& named_by) const;

  /// Remembers a file that the scene names and the program does not read, such as an image.
  void remember(const std::filesystem::path& file) const { files_->push_back(file); }
  const std::vector<std::filesystem::path>& files() const { return *files_; }

 private:
  std::filesystem::path folder_;
  bool is_outside_allowed_;
  std::shared_ptr<std::vector<std::filesystem::path>> files_ =
      std::make_shared<std::vector<std::filesystem::path>>();
};

}  // namespace testbench
