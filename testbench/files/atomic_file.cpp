#include "testbench/files/atomic_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <deque>
#include <exception>
#include <new>
#include <string>
#include <system_error>

#include "testbench/system/descriptor.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail_input(const fs::path& path, const std::string& found) {
  throw InputError(path.string() + ": output file: found " + found +
                   "; allowed: a new or regular file in an existing directory that can be written to");
}

void require_regular(const fs::path& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (!path.has_filename()) fail_input(path, "no file name");
  if (fs::is_directory(status)) fail_input(path, "a directory");
  if (fs::exists(status) && !fs::is_regular_file(status)) fail_input(path, "a device, pipe or socket");
}

constexpr std::string_view kEnding = ".tmp";
constexpr const char* kConvertersEnding = ".hier";  // what vcd2fst puts beside its output

/// ".image.exr.csx600."
std::string beginning_of(const fs::path& target) {
  return "." + target.filename().string() + ".csx600.";
}

/// Whether a file of that name is a temporary one of the target: the beginning, "PROCESS.NUMBER", the ending.
bool is_temporary_of(const std::string& beginning, const std::string& name) {
  if (name.size() < beginning.size() + kEnding.size()) return false;
  const std::size_t end = name.size() - kEnding.size();
  if (name.compare(0, beginning.size(), beginning) != 0 || name.substr(end) != kEnding) return false;
  const std::string numbers = name.substr(beginning.size(), end - beginning.size());
  const auto is_digit = [](unsigned char c) { return std::isdigit(c) != 0; };
  const std::size_t dot = numbers.find('.');
  return dot != std::string::npos && dot > 0 && dot + 1 < numbers.size() &&
         std::count_if(numbers.begin(), numbers.end(), is_digit) == std::ptrdiff_t(numbers.size()) - 1;
}

/// Removes a temporary file unless a process that runs, here or on another machine, holds its lock.
void remove_unless_locked(const fs::path& temporary) {
  const int descriptor = open(temporary.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return;
  struct stat status {};
  const bool is_file = fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
  std::error_code ignored;
  if (is_file && flock(descriptor, LOCK_EX | LOCK_NB) == 0) {
    fs::remove(temporary.string() + kConvertersEnding, ignored);
    fs::remove(temporary, ignored);
  }
  close(descriptor);
}

void remove_left_behind(const fs::path& target) {
  std::error_code error;
  const std::string beginning = beginning_of(target);
  const fs::path directory = target.has_parent_path() ? target.parent_path() : fs::path(".");
  for (fs::directory_iterator entry(directory, error), end; !error && entry != end; entry.increment(error)) {
    if (is_temporary_of(beginning, entry->path().filename().string())) remove_unless_locked(entry->path());
  }
}

/// Whether the locked file still has its name; another process may have taken it for a left one in between.
bool is_still_there(int descriptor) {
  struct stat status {};
  return fstat(descriptor, &status) == 0 && status.st_nlink > 0;
}

/// Creates an empty file of a new name beside `path`.
/// @param[out] lock the descriptor that holds the file's lock
fs::path create_temporary(const fs::path& path, int& lock) {
  require_regular(path);
  remove_left_behind(path);
  for (int number = 0;; ++number) {
    fs::path temporary = path.parent_path() / (beginning_of(path) + std::to_string(getpid()) + "." +
                                               std::to_string(number) + std::string(kEnding));
    const int descriptor = open(temporary.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
    if (descriptor < 0 && errno == EEXIST) continue;
    if (descriptor < 0) fail_input(path, "that it cannot be created (" + system_message(errno) + ")");
    flock(descriptor, LOCK_EX);  // a file system without locks has no process that looks for them either
    if (is_still_there(descriptor)) {
      lock = descriptor;
      return temporary;
    }
    close(descriptor);
  }
}

void write_bytes(const fs::path& temporary, std::string_view bytes, const fs::path& target) {
  const int descriptor = open(temporary.c_str(), O_WRONLY | O_CLOEXEC);
  int error = descriptor < 0 ? errno : write_all(descriptor, bytes);
  if (descriptor >= 0 && close(descriptor) != 0 && error == 0) error = errno;
  if (error != 0) throw RunError(target.string() + ": cannot be written: " + system_message(error));
}

}  // namespace

TemporaryFile::TemporaryFile(const fs::path& target) : path_(create_temporary(target, lock_)) {}

TemporaryFile::~TemporaryFile() {
  std::error_code ignored;
  if (!path_.empty()) fs::remove(path_, ignored);
  release();
}

void TemporaryFile::release() {
  if (lock_ >= 0) close(lock_);
  lock_ = -1;
}

void TemporaryFile::rename_to(const fs::path& target) {
  std::error_code error;
  fs::rename(path_, target, error);
  if (error) throw RunError(target.string() + ": cannot be replaced: " + error.message());
  path_.clear();
  release();
}

void write_atomically(const fs::path& path, const std::function<void(const fs::path& temporary)>& write) {
  TemporaryFile temporary(path);
  try {
    write(temporary.path());
  } catch (const InputError&) {
    throw;
  } catch (const RunError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw RunError(path.string() + ": cannot be written: " + error.what());
  }
  temporary.rename_to(path);
}

void write_bytes_atomically(const fs::path& path, std::string_view bytes) {
  write_atomically(path, [&](const fs::path& temporary) { write_bytes(temporary, bytes, path); });
}

namespace {

/// Throws RunError unless what was written to a file or folder is on the disk.
void synchronise(const fs::path& path, const fs::path& target) {
  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const bool is_synchronised = descriptor >= 0 && fsync(descriptor) == 0;
  const int error = errno;
  if (descriptor >= 0) close(descriptor);
  if (!is_synchronised) throw RunError(target.string() + ": cannot be written: " + system_message(error));
}

/// The old file gets a second name before the new one takes its first, so that it has a name at any moment. A
/// file system without hard links keeps no old file.
void keep_previous(const fs::path& path, const fs::path& previous) {
  std::error_code ignored;
  const fs::path second = previous.string() + ".new";
  fs::remove(second, ignored);
  std::error_code error;
  fs::create_hard_link(path, second, error);
  if (!error) fs::rename(second, previous, ignored);
}

}  // namespace

void replace_durably(const fs::path& path, std::string_view bytes) {
  TemporaryFile temporary(path);
  write_bytes(temporary.path(), bytes, path);
  synchronise(temporary.path(), path);
  keep_previous(path, path.string() + ".previous");
  temporary.rename_to(path);
  synchronise(path.has_parent_path() ? path.parent_path() : fs::path("."), path);
}

void write_together(const std::vector<std::pair<fs::path, std::string>>& files) {
  std::deque<TemporaryFile> temporaries;
  for (const auto& [path, bytes] : files) write_bytes(temporaries.emplace_back(path).path(), bytes, path);
  for (std::size_t i = 0; i < files.size(); ++i) temporaries[i].rename_to(files[i].first);
}

void require_writable(const fs::path& path) {
  const TemporaryFile probe(path);
}

}  // namespace testbench
