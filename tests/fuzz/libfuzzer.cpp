// The functions that clang's libFuzzer calls:
//
//     build/fuzz/fuzz_readers --target=NAME CORPUS          fuzzes
//     build/fuzz/fuzz_readers --target=NAME --show FILE     reads one input and prints what the user is told

#include <stdlib.h>  // NOLINT(modernize-deprecated-headers): POSIX's has mkdtemp

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>

#include "tests/fuzz/targets.hpp"

namespace {

namespace fs = std::filesystem;

/// What the process reads, and where: an empty directory of its own.
struct Process {
  const fuzz::Target* target = nullptr;
  bool shows_messages = false;
  fs::path home = fs::current_path();
  fs::path directory;

  Process() {
    std::string pattern = fs::temp_directory_path() / "csx600_fuzz_XXXXXX";
    if (mkdtemp(pattern.data()) == nullptr) fuzz::fail("no temporary directory");
    directory = pattern;
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  ~Process() { fs::remove_all(directory); }
};

Process& process() {
  static Process only;
  return only;
}

}  // namespace

/// SystemC's library, which some headers need, calls it.
extern "C" int sc_main(int, char**) {
  return 0;
}

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  constexpr std::string_view kOption = "--target=";
  for (int i = 1; i < *argc; ++i) {
    const std::string_view word = (*argv)[i];
    if (word.substr(0, kOption.size()) == kOption)
      process().target = fuzz::find_target(word.substr(kOption.size()));
    if (word == "--show") process().shows_messages = true;
  }
  if (process().target != nullptr) return 0;
  std::fprintf(stderr, "--target: found none or an unknown one; allowed: --target=NAME with one of");
  for (const fuzz::Target& target : fuzz::targets())
    std::fprintf(stderr, " %.*s", int(target.name.size()), target.name.data());
  std::fprintf(stderr, "\n");
  std::exit(2);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // libFuzzer itself reads and writes its corpus between two calls, by paths from where it was started.
  fs::current_path(process().directory);
  const std::string message =
      fuzz::read_input(*process().target, {reinterpret_cast<const char*>(data), size});
  if (process().shows_messages) std::fprintf(stderr, "%s\n", message.empty() ? "read" : message.c_str());
  fs::current_path(process().home);
  return 0;
}
