// Every input that is kept is read as the fuzzer reads it.

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "testbench/system/simulator_time.hpp"
#include "tests/fuzz/targets.hpp"
#include "tests/support/temporary_directory.hpp"

namespace fuzz {

/// GoogleTest's name of a parameter.
void PrintTo(const Target& target, std::ostream* out) {
  *out << target.name;
}

}  // namespace fuzz

namespace corpus_test {

namespace fs = std::filesystem;
using fuzz::Target;

const fs::path kFolder = fs::path(CSX600_SOURCE_DIR) / "tests/fuzz";

std::vector<fs::path> entries_of(const fs::path& folder) {
  std::vector<fs::path> entries;
  if (fs::is_directory(folder))
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) entries.push_back(entry.path());
  std::sort(entries.begin(), entries.end());
  return entries;
}

/// While it lives, this process gets 512 MiB more than it has. AddressSanitizer takes terabytes of addresses,
/// so with it there is no limit.
class MemoryLimit {
 public:
  MemoryLimit() {
    getrlimit(RLIMIT_AS, &before_);
    std::uint64_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    rlimit limit = before_;
    limit.rlim_cur = pages * std::uint64_t(getpagesize()) + (std::uint64_t{512} << 20);
    if (!kIsSanitized) setrlimit(RLIMIT_AS, &limit);
  }
  ~MemoryLimit() { setrlimit(RLIMIT_AS, &before_); }
  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;

 private:
#ifdef __SANITIZE_ADDRESS__
  static constexpr bool kIsSanitized = true;
#else
  static constexpr bool kIsSanitized = false;
#endif
  rlimit before_{};
};

class Corpus : public testing::TestWithParam<Target> {
 protected:
  Corpus() { fs::current_path(temporary_.path()); }
  ~Corpus() override { fs::current_path(home_); }

  static void read_all(const char* kind) {
    for (const fs::path& file : entries_of(kFolder / kind / GetParam().name)) {
      SCOPED_TRACE(file);
      const std::string input = test_support::read_file(file);
      const testbench::SimulatorTimer timer;
      const MemoryLimit limit;
      EXPECT_NO_THROW(fuzz::read_input(GetParam(), input));
      EXPECT_LT(timer.cpu_seconds(), 10);
    }
  }

 private:
  fs::path home_ = fs::current_path();
  test_support::TemporaryDirectory temporary_;
};

TEST_P(Corpus, IsReadOrRefusedInOneLine) {
  EXPECT_FALSE(entries_of(kFolder / "corpus" / GetParam().name).empty());
  read_all("corpus");
}

TEST_P(Corpus, OfFindingsIsReadOrRefusedInOneLine) {
  read_all("regressions");
}

INSTANTIATE_TEST_SUITE_P(Readers, Corpus, testing::ValuesIn(fuzz::targets()),
                         [](const testing::TestParamInfo<Target>& target) {
                           return std::string(target.param.name);
                         });

TEST(Targets, HaveAllFoldersAndDictionaries) {
  for (const char* const kind : {"corpus", "regressions", "dictionaries"})
    for (const fs::path& entry : entries_of(kFolder / kind))
      EXPECT_NE(fuzz::find_target(entry.stem().string()), nullptr) << entry << " belongs to no target";
}

}  // namespace corpus_test
