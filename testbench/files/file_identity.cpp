#include "testbench/files/file_identity.hpp"

#include <sys/stat.h>

#include <system_error>

namespace testbench {

FileIdentity::FileIdentity(const std::filesystem::path& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) == 0) inode_.emplace(status.st_dev, status.st_ino);
  std::error_code error;
  const std::filesystem::path absolute = std::filesystem::absolute(path, error);
  canonical_ = std::filesystem::weakly_canonical(absolute, error);
  if (error) canonical_ = absolute.lexically_normal();  // a directory that may not be searched
}

bool operator==(const FileIdentity& a, const FileIdentity& b) {
  return (a.inode_ && a.inode_ == b.inode_) || a.canonical_ == b.canonical_;
}

}  // namespace testbench
