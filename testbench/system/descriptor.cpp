#include "testbench/system/descriptor.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace testbench {
namespace {

/// `put(data, size)` returns how many bytes it took, or -1 with errno set.
template <class Put>
int put_all(std::string_view bytes, Put&& put) {
  while (!bytes.empty()) {
    const ssize_t count = put(bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return errno;
    if (count == 0) return EIO;
    bytes.remove_prefix(std::size_t(count));
  }
  return 0;
}

}  // namespace

int write_all(int descriptor, std::string_view bytes) {
  return put_all(bytes,
                 [descriptor](const char* data, std::size_t size) { return write(descriptor, data, size); });
}

int send_all(int socket, std::string_view bytes) {
  return put_all(
      bytes, [socket](const char* data, std::size_t size) { return send(socket, data, size, MSG_NOSIGNAL); });
}

std::string system_message(int error) {
  return std::generic_category().message(error);
}

}  // namespace testbench
