#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "testbench/files/atomic_file.hpp"

namespace testbench {

/// Those who write many short lines collect so much before they hand it on.
inline constexpr std::size_t kWriteBufferBytes = 64 * 1024;

/// A file that is written piece by piece while a chip runs. It has a temporary name until finish(); without
/// finish() it is removed.
class OutputStream {
 public:
  virtual ~OutputStream() = default;

  /// Never throws, so that a run in progress is not lost. After the first failure all further bytes are
  /// dropped, and finish() reports that failure.
  virtual void write(std::string_view bytes) noexcept = 0;
  /// Gives the complete file its name. Throws RunError with the first failure.
  virtual void finish() = 0;
};

class StreamedFile : public OutputStream {
 public:
  /// Throws InputError if the file cannot be created.
  explicit StreamedFile(const std::filesystem::path& path);
  ~StreamedFile() override;
  StreamedFile(const StreamedFile&) = delete;
  StreamedFile& operator=(const StreamedFile&) = delete;

  void write(std::string_view bytes) noexcept override;
  void finish() override;

 private:
  std::filesystem::path path_;
  TemporaryFile temporary_;
  int descriptor_;
  int error_ = 0;
};

/// Converts the VCD written to it into an FST file, with the program vcd2fst (Debian package gtkwave). No VCD
/// reaches the disk.
class FstFile : public OutputStream {
 public:
  /// Throws InputError if the file cannot be created or vcd2fst is not installed.
  explicit FstFile(const std::filesystem::path& path);
  ~FstFile() override;
  FstFile(const FstFile&) = delete;
  FstFile& operator=(const FstFile&) = delete;

  void write(std::string_view bytes) noexcept override;
  void finish() override;

 private:
  void start_converter();
  int end_converter();

  std::filesystem::path path_;
  TemporaryFile temporary_;
  int socket_ = -1;
  int converter_ = -1;  ///< process ID; -1 when none runs
  int error_ = 0;
};

/// An FstFile for a name that ends in ".fst", a StreamedFile for any other name.
std::unique_ptr<OutputStream> make_wave_stream(const std::filesystem::path& path);

}  // namespace testbench
