#pragma once

#include <filesystem>
#include <string>

namespace testbench {

/// Which files a scene may read: those below its own folder, so that a scene from a stranger shows nothing
/// else of the machine. --allow-outside lifts the limit.
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

 private:
  std::filesystem::path folder_;
  bool is_outside_allowed_;
};

}  // namespace testbench
