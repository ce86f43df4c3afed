#include "testbench/files/input_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "testbench/system/descriptor.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& found,
                         const std::string& allowed) {
  throw InputError(path.string() + ": found " + found + "; allowed: " + allowed);
}

[[noreturn]] void refuse_unreadable(const std::filesystem::path& path, int error,
                                    const std::string& allowed) {
  refuse(path, "that it cannot be read (" + system_message(error) + ")", allowed);
}

/// A descriptor that is open for reading. Opening a FIFO does not wait for a writer.
class InputDescriptor {
 public:
  explicit InputDescriptor(const std::filesystem::path& path)
      : descriptor_(open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)) {}
  ~InputDescriptor() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  InputDescriptor(const InputDescriptor&) = delete;
  InputDescriptor& operator=(const InputDescriptor&) = delete;

  int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

/// The size in bytes of an open file.
std::uint64_t require_regular(const InputDescriptor& file, const std::filesystem::path& path,
                              const std::string& allowed, std::uint64_t most_bytes) {
  struct stat status {};
  if (file.descriptor() < 0 || fstat(file.descriptor(), &status) != 0)
    refuse_unreadable(path, errno, allowed);
  if (S_ISDIR(status.st_mode)) refuse_unreadable(path, EISDIR, allowed);
  if (!S_ISREG(status.st_mode)) refuse(path, "a device, pipe or socket", allowed);
  const auto bytes = std::uint64_t(status.st_size);
  if (bytes > most_bytes)
    refuse(path, std::to_string(bytes) + " bytes",
           allowed + " of at most " + std::to_string(most_bytes) + " bytes");
  return bytes;
}

}  // namespace

void require_input_file(const std::filesystem::path& path, const std::string& allowed,
                        std::uint64_t most_bytes) {
  require_regular(InputDescriptor(path), path, allowed, most_bytes);
}

std::string read_input_file(const std::filesystem::path& path, const std::string& allowed,
                            std::uint64_t most_bytes) {
  const InputDescriptor file(path);
  std::string bytes(require_regular(file, path, allowed, most_bytes), '\0');
  std::size_t size = 0;
  while (size < bytes.size()) {
    const ssize_t count = read(file.descriptor(), bytes.data() + size, bytes.size() - size);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) refuse_unreadable(path, errno, allowed);
    if (count == 0) break;
    size += std::size_t(count);
  }
  bytes.resize(size);
  return bytes;
}

}  // namespace testbench
