#pragma once

#include <string>
#include <string_view>

namespace testbench {

/// Write all bytes to a file, pipe or socket, and go on after signals. Return 0, or errno of the first
/// failure. A peer that has closed its end of a socket is the error EPIPE, not a signal.
int write_all(int descriptor, std::string_view bytes);
int send_all(int socket, std::string_view bytes);

/// The operating system's text for a value of errno.
std::string system_message(int error);

}  // namespace testbench
