#include "testbench/system/input_file.hpp"

#include <cerrno>
#include <fstream>
#include <sstream>
#include <system_error>

#include "testbench/system/descriptor.hpp"
#include "testbench/system/error.hpp"

namespace testbench {

std::string read_input_file(const std::filesystem::path& path, const std::string& allowed) {
  std::ostringstream bytes;
  std::ifstream stream(path, std::ios::binary);
  const int error = errno;
  std::error_code ignored;
  const bool is_directory = std::filesystem::is_directory(path, ignored);
  const bool is_empty = stream && !is_directory && stream.peek() == std::ifstream::traits_type::eof();
  if (is_empty) return "";
  if (!stream || is_directory || !(bytes << stream.rdbuf()))
    throw InputError(path.string() + ": found that it cannot be read (" +
                     system_message(is_directory ? EISDIR : error) + "); allowed: " + allowed);
  return std::move(bytes).str();
}

}  // namespace testbench
