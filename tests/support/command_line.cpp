#include "tests/support/command_line.hpp"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "tests/support/temporary_directory.hpp"

namespace test_support {
namespace {

/// A longer run is ended by a signal, because the test expected it not to start.
constexpr unsigned kMostSeconds = 100;

std::filesystem::path output_of(pid_t child, const std::filesystem::path& directory, const char* name) {
  return directory.string() + "." + std::to_string(child) + "." + name;
}

void redirect(int descriptor, const std::filesystem::path& file) {
  const int opened = open(file.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600);
  if (opened < 0 || dup2(opened, descriptor) < 0) _exit(126);
}

}  // namespace

std::vector<std::string> CommandResult::error_lines() const {
  std::vector<std::string> lines;
  std::istringstream text(error);
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

CommandLineFixture::CommandLineFixture() {
  std::string pattern = testing::TempDir() + "csx600_test_XXXXXX";
  directory_ = mkdtemp(pattern.data());
}

CommandLineFixture::~CommandLineFixture() {
  std::filesystem::permissions(directory_, std::filesystem::perms::owner_all);
  std::filesystem::remove_all(directory_);
}

CommandResult CommandLineFixture::run(const std::vector<std::string>& arguments) {
  return finish(start(arguments));
}

pid_t CommandLineFixture::start(const std::vector<std::string>& arguments) {
  std::vector<std::string> words = {CSX600_BINARY};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    redirect(STDOUT_FILENO, output_of(getpid(), directory_, "out"));
    redirect(STDERR_FILENO, output_of(getpid(), directory_, "error"));
    alarm(kMostSeconds);
    if (chdir(directory_.c_str()) == 0) execv(pointers[0], pointers.data());
    _exit(127);
  }
  EXPECT_GT(child, 0);
  return child;
}

CommandResult CommandLineFixture::finish(pid_t child) {
  int status = 0;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  CommandResult result;
  if (WIFEXITED(status)) result.exit_code = WEXITSTATUS(status);
  result.out = read_file(output_of(child, directory_, "out"));
  result.error = read_file(output_of(child, directory_, "error"));
  for (const char* name : {"out", "error"}) std::filesystem::remove(output_of(child, directory_, name));
  return result;
}

void CommandLineFixture::write(const std::string& name, const std::string& text) const {
  std::filesystem::create_directories((directory_ / name).parent_path());
  std::ofstream(directory_ / name, std::ios::binary) << text;
}

std::string CommandLineFixture::read(const std::string& name) const {
  return read_file(directory_ / name);
}

std::vector<std::string> CommandLineFixture::files() const {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(directory_))
    if (!entry.is_directory()) names.push_back(std::filesystem::relative(entry.path(), directory_).string());
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace test_support
