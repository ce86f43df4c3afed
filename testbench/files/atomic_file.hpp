#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace testbench {

/// A new, empty file in the directory of `target`. The destructor removes it unless rename_to() has been
/// called. Its name is .NAME.csx600.PROCESS.NUMBER.tmp, and it is locked (flock) as long as it is in use.
/// What a killed process has left for the same target has such a name and no lock; the next file for that
/// target removes it.
class TemporaryFile {
 public:
  /// Throws InputError if no file can be created there or `target` exists and is not a regular file.
  explicit TemporaryFile(const std::filesystem::path& target);
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile();

  const std::filesystem::path& path() const { return path_; }
  /// Throws RunError.
  void rename_to(const std::filesystem::path& target);

 private:
  void release();

  int lock_ = -1;  ///< descriptor that holds the lock; before path_, whose constructor sets it
  std::filesystem::path path_;
};

/// Calls `write` with the name of a new, empty file in the directory of `path`, then renames that file to
/// `path`. So `path` holds either its old content or all of the new, never a part. The temporary file is
/// removed when writing fails. Throws InputError if no file can be created there or `path` is not a regular
/// file, and RunError if writing fails. Any other exception that `write` throws becomes a RunError that names
/// `path`.
void write_atomically(const std::filesystem::path& path,
                      const std::function<void(const std::filesystem::path& temporary)>& write);

/// write_atomically() for content that is already in memory. Throws RunError on a short write (disk full).
void write_bytes_atomically(const std::filesystem::path& path, std::string_view bytes);

/// write_bytes_atomically() for a file that must survive a loss of power: the bytes are on the disk before
/// they get the file's name. What the file held before stays as PATH.previous.
void replace_durably(const std::filesystem::path& path, std::string_view bytes);

/// Writes several files that make sense only together: all are whole before the first gets its name, so a
/// full disk leaves none of them. Throws as write_bytes_atomically() does.
void write_together(const std::vector<std::pair<std::filesystem::path, std::string>>& files);

/// Checks before a long run that write_atomically(path) can start; throws InputError if it cannot. Leaves no
/// file behind.
void require_writable(const std::filesystem::path& path);

}  // namespace testbench
