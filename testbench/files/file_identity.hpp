#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <utility>

namespace testbench {

/// Which file a path leads to, however it is spelled: by device and inode if it exists (so also through
/// links), otherwise by its canonical path.
class FileIdentity {
 public:
  explicit FileIdentity(const std::filesystem::path& path);

  friend bool operator==(const FileIdentity& a, const FileIdentity& b);

 private:
  std::optional<std::pair<dev_t, ino_t>> inode_;
  std::filesystem::path canonical_;
};

}  // namespace testbench
