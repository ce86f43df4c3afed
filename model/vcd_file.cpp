#include "model/vcd_file.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <fstream>
#include <system_error>

namespace model {
namespace {

constexpr std::size_t kLongestHeader = 64 * 1024;
constexpr std::size_t kLongestTimeStamp = 64;

std::string read_at_most(std::istream& in, std::size_t bytes) {
  std::string text(bytes, '\0');
  in.read(text.data(), static_cast<std::streamsize>(bytes));
  text.resize(std::size_t(in.gcount()));
  in.clear();
  return text;
}

}  // namespace

std::string create_vcd_file(const std::filesystem::path& file) {
  std::error_code ignored;
  if (std::filesystem::is_fifo(file, ignored)) return {};  // opening would wait for its reader
  errno = 0;
  if (std::ofstream(file, std::ios::trunc)) return {};
  return std::generic_category().message(errno);
}

void write_initial_time(const std::filesystem::path& file, std::uint64_t time_units) {
  if (!std::filesystem::is_regular_file(file)) return;
  std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
  const std::string header = read_at_most(stream, kLongestHeader);
  const std::size_t end_of_definitions = header.find("$enddefinitions");
  const std::size_t values = header.find("$dumpvars", end_of_definitions);
  const std::size_t comment = header.find("$comment", end_of_definitions);
  if (values == std::string::npos || comment >= values) return;
  std::string stamp = "#" + std::to_string(time_units);
  if (stamp.size() >= values - comment) return;
  stamp.append(values - comment - stamp.size() - 1, ' ').push_back('\n');
  stream.seekp(static_cast<std::streamoff>(comment));
  stream.write(stamp.data(), static_cast<std::streamsize>(stamp.size()));
}

std::optional<std::uint64_t> closing_time(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary | std::ios::ate);
  const auto size = static_cast<std::size_t>(std::max<std::streamoff>(0, stream.tellg()));
  const std::size_t tail = std::min(size, kLongestTimeStamp);
  stream.seekg(static_cast<std::streamoff>(size - tail));
  const std::string text = read_at_most(stream, tail);
  const std::size_t mark = text.rfind("\n#");
  if (mark == std::string::npos || text.back() != '\n') return std::nullopt;
  std::uint64_t time = 0;
  const char* const last_line_end = text.data() + text.size() - 1;
  const auto parsed = std::from_chars(text.data() + mark + 2, last_line_end, time);
  if (parsed.ec != std::errc() || parsed.ptr != last_line_end) return std::nullopt;
  return time;
}

}  // namespace model
