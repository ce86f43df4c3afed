#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>  // NOLINT(modernize-deprecated-headers): POSIX's has mkdtemp

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace test_support {

/// A new, empty directory that the destructor removes.
class TemporaryDirectory {
 public:
  TemporaryDirectory() {
    std::string pattern = testing::TempDir() + "csx600_test_XXXXXX";
    path_ = mkdtemp(pattern.data());
  }
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;
  ~TemporaryDirectory() { std::filesystem::remove_all(path_); }

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

inline std::string read_file(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

/// Gives each test a temporary directory.
class DirectoryFixture : public testing::Test {
  TemporaryDirectory temporary_;

 protected:
  /// Writes a file of the directory and returns its path.
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(directory_ / name, std::ios::binary) << text;
    return directory_ / name;
  }
  /// The content of a file of the directory.
  std::string read(const std::string& name) const { return read_file(directory_ / name); }

  const std::filesystem::path directory_ = temporary_.path();
};

}  // namespace test_support
