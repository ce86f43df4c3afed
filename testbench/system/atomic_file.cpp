#include "testbench/system/atomic_file.hpp"

#include <fcntl.h>
#include <unistd.h>
#include <cerrno>
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

/// Creates an empty file of a new name beside `path`. The name shows where the file came from, in case it
/// survives a kill: .<name>.<process>.<number>.tmp
fs::path create_temporary(const fs::path& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (!path.has_filename()) fail_input(path, "no file name");
  if (fs::is_directory(status)) fail_input(path, "a directory");
  if (fs::exists(status) && !fs::is_regular_file(status)) fail_input(path, "a device, pipe or socket");
  for (int number = 0;; ++number) {
    fs::path temporary =
        path.parent_path() / ("." + path.filename().string() + "." + std::to_string(getpid()) + "." +
                              std::to_string(number) + ".tmp");
    const int descriptor = open(temporary.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
    if (descriptor >= 0) {
      close(descriptor);
      return temporary;
    }
    if (errno != EEXIST) fail_input(path, "that it cannot be created (" + system_message(errno) + ")");
  }
}

void write_bytes(const fs::path& temporary, std::string_view bytes, const fs::path& target) {
  const int descriptor = open(temporary.c_str(), O_WRONLY | O_CLOEXEC);
  int error = descriptor < 0 ? errno : write_all(descriptor, bytes);
  if (descriptor >= 0 && close(descriptor) != 0 && error == 0) error = errno;
  if (error != 0) throw RunError(target.string() + ": cannot be written: " + system_message(error));
}

}  // namespace

TemporaryFile::TemporaryFile(const fs::path& target) : path_(create_temporary(target)) {}

TemporaryFile::~TemporaryFile() {
  std::error_code ignored;
  if (!path_.empty()) fs::remove(path_, ignored);
}

void TemporaryFile::rename_to(const fs::path& target) {
  std::error_code error;
  fs::rename(path_, target, error);
  if (error) throw RunError(target.string() + ": cannot be replaced: " + error.message());
  path_.clear();
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

void require_writable(const fs::path& path) {
  const TemporaryFile probe(path);
}

}  // namespace testbench
