#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>

namespace testbench {

/// A file that is written in pieces by a library that may lose errors: the first one is kept for finish().
class CheckedFile {
 public:
  /// @param path of an existing file, which is emptied. @param target the name in messages
  CheckedFile(const std::filesystem::path& path, std::filesystem::path target);

  /// For functions that write to a stream themselves.
  std::FILE* stream() { return stream_.get(); }
  /// Both return false from the first failure on.
  bool write(const char* bytes, std::size_t size);
  bool seek(std::uint64_t place);
  std::uint64_t place();
  /// To be called behind the last byte. Throws RunError for the first failure.
  void finish();

 private:
  bool keep_error(bool is_good);

  struct Closer {
    void operator()(std::FILE* stream) const { std::fclose(stream); }
  };
  std::filesystem::path target_;
  std::unique_ptr<std::FILE, Closer> stream_;
  int error_ = 0;  ///< errno of the first failure
};

}  // namespace testbench
