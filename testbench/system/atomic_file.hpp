#pragma once

#include <filesystem>
#include <functional>
#include <string_view>

namespace testbench {

/// A new, empty file in the directory of `target`, removed at the end of the scope unless it was renamed
/// away.
class TemporaryFile {
 public:
  /// Throws InputError if nothing can be created there or `target` is not a regular file.
  explicit TemporaryFile(const std::filesystem::path& target);
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile();

  const std::filesystem::path& path() const { return path_; }
  /// Throws RunError.
  void rename_to(const std::filesystem::path& target);

 private:
  std::filesystem::path path_;
};

/// Calls `write` with the name of a new, empty file in the directory of `path`, then renames that file to
/// `path`: `path` holds either its old content or all of the new, never a part. If anything fails the
/// temporary file is removed. Throws InputError if nothing can be created there or `path` is not a regular
/// file, RunError if writing fails (an exception of `write` that is not an InputError or RunError becomes a
/// RunError naming `path`).
void write_atomically(const std::filesystem::path& path,
                      const std::function<void(const std::filesystem::path& temporary)>& write);

/// write_atomically() of a whole content that is already in memory. RunError on a short write (disk full).
void write_bytes_atomically(const std::filesystem::path& path, std::string_view bytes);

/// Checks before a long run that write_atomically(path) can start: InputError if it cannot. Leaves nothing
/// behind.
void require_writable(const std::filesystem::path& path);

}  // namespace testbench
