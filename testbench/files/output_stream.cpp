#include "testbench/files/output_stream.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <fstream>
#include <system_error>

#include "testbench/system/descriptor.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kConverter = "vcd2fst";

[[noreturn]] void fail(const fs::path& path, const std::string& what) {
  throw RunError(path.string() + ": cannot be written: " + what);
}

/// Whether the file ends where a block ends. An FST is a chain of blocks, each with a type byte and eight
/// bytes of length, most significant first. The converter ignores failed writes, so a full disk leaves a file
/// that ends within a block.
bool is_whole_fst(const fs::path& path) {
  constexpr std::uint64_t kTypeBytes = 1;
  const std::uint64_t size = fs::file_size(path);
  std::ifstream in(path, std::ios::binary);
  std::uint64_t place = 0;
  while (place < size) {
    std::array<char, 9> head{};
    in.seekg(std::streamoff(place));
    if (!in.read(head.data(), head.size())) return false;
    std::uint64_t length = 0;
    for (std::size_t i = kTypeBytes; i < head.size(); ++i)
      length = length << 8 | static_cast<unsigned char>(head[i]);
    if (length < sizeof(length) || length > size - place - kTypeBytes) return false;
    place += kTypeBytes + length;
  }
  return size > 0;
}

std::string text_of_end(int status) {
  const std::string name = kConverter;
  if (WIFSIGNALED(status)) return name + " was ended by signal " + std::to_string(WTERMSIG(status));
  return name + " ended early with exit code " + std::to_string(WEXITSTATUS(status));
}

}  // namespace

StreamedFile::StreamedFile(const fs::path& path)
    : path_(path),
      temporary_(path),
      descriptor_(open(temporary_.path().c_str(), O_WRONLY | O_TRUNC | O_CLOEXEC)) {
  if (descriptor_ < 0) error_ = errno;
}

StreamedFile::~StreamedFile() {
  if (descriptor_ >= 0) close(descriptor_);
}

void StreamedFile::write(std::string_view bytes) noexcept {
  if (error_ == 0) error_ = write_all(descriptor_, bytes);
}

void StreamedFile::finish() {
  if (error_ == 0 && close(descriptor_) != 0) error_ = errno;
  descriptor_ = -1;
  if (error_ != 0) fail(path_, system_message(error_));
  temporary_.rename_to(path_);
}

FstFile::FstFile(const fs::path& path) : path_(path), temporary_(path) {
  start_converter();
}

FstFile::~FstFile() {
  if (converter_ >= 0) end_converter();
  std::error_code ignored;  // the converter's own temporary file
  if (!temporary_.path().empty()) fs::remove(temporary_.path().string() + ".hier", ignored);
}

/// Uses a socket rather than a pipe, because send() can be told not to raise SIGPIPE when the reader has
/// ended.
void FstFile::start_converter() {
  std::array<int, 2> ends;
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
    fail(path_, system_message(errno));
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
  for (const int output : {STDOUT_FILENO, STDERR_FILENO})
    posix_spawn_file_actions_addopen(&actions, output, "/dev/null", O_WRONLY, 0);
  std::string name = kConverter;
  std::string input = "-";
  std::string output = temporary_.path().string();
  std::array<char*, 4> arguments = {name.data(), input.data(), output.data(), nullptr};
  pid_t process = -1;
  const int error = posix_spawnp(&process, kConverter, &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  socket_ = ends[0];
  if (error == 0) {
    converter_ = process;
    return;
  }
  close(socket_);
  throw InputError(
      path_.string() + ": found no program " + kConverter + " (" + system_message(error) +
      "), which writes .fst; allowed: install it (Debian: gtkwave), or a name that ends in .vcd");
}

void FstFile::write(std::string_view bytes) noexcept {
  if (error_ == 0) error_ = send_all(socket_, bytes);
}

/// Closes the converter's input, waits for its end and returns its wait status.
int FstFile::end_converter() {
  close(socket_);
  int status = 0;
  while (waitpid(converter_, &status, 0) < 0 && errno == EINTR) {
  }
  converter_ = -1;
  return status;
}

void FstFile::finish() {
  const int status = end_converter();
  if (status != 0 || error_ == EPIPE || error_ == ECONNRESET) fail(path_, text_of_end(status));
  if (error_ != 0) fail(path_, system_message(error_));
  if (!is_whole_fst(temporary_.path())) fail(path_, "the file is cut short; is the disk full?");
  temporary_.rename_to(path_);
}

std::unique_ptr<OutputStream> make_wave_stream(const fs::path& path) {
  if (path.extension() == ".fst") return std::make_unique<FstFile>(path);
  return std::make_unique<StreamedFile>(path);
}

}  // namespace testbench
