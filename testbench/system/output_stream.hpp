#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "testbench/system/atomic_file.hpp"

namespace testbench {

/// Those who write many short lines collect so much before they hand it on.
inline constexpr std::size_t kWriteBufferBytes = 64 * 1024;

/// A file that is written piece by piece while a chip runs. It has a temporary name until finish(); without
/// it, nothing is left.
class OutputStream {
 public:
  virtual ~OutputStream() = default;

  /// Never throws, so that a run in progress is not lost: after the first failure nothing more is written,
  /// and finish() tells.
  virtual void write(std::string_view bytes) noexcept = 0;
  /// All was written: gives the file its name. Throws RunError with the first failure.
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

/// Takes a VCD and leaves an FST: feeds vcd2fst (Debian: gtkwave), so that no VCD reaches the disk.
class FstFile : public OutputStream {
 public:
  /// Throws InputError if the file cannot be created or there is no vcd2fst.
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
  int converter_ = -1;  ///< process
  int error_ = 0;
};

/// By the name's end: ".fst" or anything else.
std::unique_ptr<OutputStream> make_wave_stream(const std::filesystem::path& path);

}  // namespace testbench
