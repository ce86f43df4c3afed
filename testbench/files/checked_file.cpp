#include "testbench/files/checked_file.hpp"

#include <cerrno>
#include <utility>

#include "testbench/system/descriptor.hpp"
#include "testbench/system/error.hpp"

namespace testbench {

CheckedFile::CheckedFile(const std::filesystem::path& path, std::filesystem::path target)
    : target_(std::move(target)), stream_(std::fopen(path.c_str(), "wbe")) {
  keep_error(stream_ != nullptr);
}

bool CheckedFile::keep_error(bool is_good) {
  if (!is_good && error_ == 0) error_ = errno != 0 ? errno : EIO;
  return error_ == 0;
}

bool CheckedFile::write(const char* bytes, std::size_t size) {
  return error_ == 0 && keep_error(std::fwrite(bytes, 1, size, stream()) == size);
}

bool CheckedFile::seek(std::uint64_t place) {
  return error_ == 0 && keep_error(fseeko(stream(), off_t(place), SEEK_SET) == 0);
}

std::uint64_t CheckedFile::place() {
  if (error_ != 0) return 0;
  const off_t place = ftello(stream());
  return keep_error(place >= 0) ? std::uint64_t(place) : 0;
}

void CheckedFile::finish() {
  if (stream_) {
    keep_error(std::ferror(stream()) == 0);
    keep_error(std::fclose(stream_.release()) == 0);
  }
  if (error_ != 0) throw RunError(target_.string() + ": cannot be written: " + system_message(error_));
}

}  // namespace testbench
