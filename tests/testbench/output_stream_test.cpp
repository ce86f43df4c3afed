#include "testbench/files/output_stream.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>

#include "model/waves/vcd_writer.hpp"
#include "testbench/system/error.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/vcd_reader.hpp"

namespace output_stream_test {

namespace fs = std::filesystem;

class OutputStream : public test_support::DirectoryFixture {
 protected:
  bool directory_is_empty() const { return fs::is_empty(directory_); }
  static std::string failure_of(const std::function<void()>& action) {
    try {
      action();
    } catch (const testbench::RunError& error) {
      return error.what();
    }
    return "";
  }
};

/// Puts a program of this name first in PATH.
class FakeProgram {
 public:
  FakeProgram(const fs::path& directory, const std::string& name, const std::string& script)
      : directory_(directory / "bin"), before_(std::getenv("PATH")) {
    fs::create_directory(directory_);
    std::ofstream(directory_ / name) << "#!/bin/sh\n" << script << "\n";
    fs::permissions(directory_ / name, fs::perms::owner_all);
    setenv("PATH", (directory_.string() + ":" + before_).c_str(), 1);
  }
  ~FakeProgram() {
    setenv("PATH", before_.c_str(), 1);
    fs::remove_all(directory_);
  }

 private:
  fs::path directory_;
  std::string before_;
};

bool has_program(const std::string& name) {
  return std::system(("command -v " + name + " > /dev/null").c_str()) == 0;
}

std::string some_vcd(int changes) {
  std::string text;
  model::VcdWriter writer([&](std::string_view piece) { text += piece; },
                          {{"chip.unit.busy", 1}, {"chip.unit.count", 16}, {"chip.other.state", 4}});
  writer.record(1000, {0, 7, 3});
  for (int i = 0; i < changes; ++i) {
    writer.time(2000 + 10 * std::uint64_t(i));
    writer.change(0, std::uint64_t(i + 1) % 2);
    writer.change(1, std::uint64_t(i * 7919) % 65536);
  }
  writer.pause(1'000'000'000);
  writer.record(2'000'000'000, {1, 9, 5});
  writer.time(2'000'000'500);
  writer.flush();
  return text;
}

TEST_F(OutputStream, FileHasItsNameOnlyWhenItIsWhole) {
  const fs::path file = directory_ / "a.txt";
  {
    testbench::StreamedFile stream(file);
    stream.write("one ");
    EXPECT_FALSE(fs::exists(file));
    stream.write("two");
    stream.finish();
  }
  EXPECT_EQ(test_support::read_file(file), "one two");
  { testbench::StreamedFile(directory_ / "b.txt").write("left"); }
  EXPECT_FALSE(fs::exists(directory_ / "b.txt"));
  EXPECT_EQ(std::distance(fs::directory_iterator(directory_), {}), 1);
}

TEST_F(OutputStream, FullDiskIsToldAtTheEndAndLeavesNothing) {
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{100'000, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  std::string failure;
  {
    testbench::StreamedFile stream(directory_ / "a.txt");
    for (int i = 0; i < 10; ++i) stream.write(std::string(30'000, 'x'));
    failure = failure_of([&] { stream.finish(); });
  }
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, SIG_DFL);
  EXPECT_NE(failure.find("a.txt: cannot be written: "), std::string::npos) << failure;
  EXPECT_TRUE(directory_is_empty());
}

TEST_F(OutputStream, FstHoldsWhatTheVcdDoes) {
  if (!has_program("vcd2fst") || !has_program("fst2vcd")) GTEST_SKIP() << "needs Debian's gtkwave";
  const std::string vcd = some_vcd(50'000);
  const fs::path file = directory_ / "a.fst";
  const auto stream = testbench::make_wave_stream(file);
  for (std::size_t i = 0; i < vcd.size(); i += 10'000) stream->write(std::string_view(vcd).substr(i, 10'000));
  stream->finish();
  EXPECT_EQ(std::distance(fs::directory_iterator(directory_), {}), 1) << "no VCD";
  const fs::path back = directory_ / "back.vcd";
  ASSERT_EQ(std::system(("fst2vcd -f " + file.string() + " -o " + back.string()).c_str()), 0);
  std::istringstream text(vcd);
  const test_support::VcdReader expected(text);
  const test_support::VcdReader found = test_support::VcdReader::of_file(back);
  ASSERT_EQ(found.signals().size(), expected.signals().size());
  for (const auto& [name, signal] : expected.signals()) {
    EXPECT_EQ(found.signals().at(name).width, signal.width);
    for (const std::uint64_t time : {1000u, 2000u, 100'000u, 501'990u, 2'000'000'000u})
      EXPECT_EQ(found.value_at(name, time), expected.value_at(name, time)) << name << " at " << time;
    EXPECT_GE(found.signals().at(name).changes.size() + 3, signal.changes.size()) << name;
  }
}

TEST_F(OutputStream, ConverterThatEndsEarlyIsTold) {
  const FakeProgram fake(directory_, "vcd2fst", "head -c 1000 > \"$2\"; exit 3");
  std::string failure;
  {
    testbench::FstFile stream(directory_ / "a.fst");
    for (int i = 0; i < 100; ++i) stream.write(std::string(30'000, 'x'));
    failure = failure_of([&] { stream.finish(); });
  }
  EXPECT_NE(failure.find("a.fst: cannot be written: vcd2fst ended early with exit code 3"), std::string::npos)
      << failure;
  EXPECT_FALSE(fs::exists(directory_ / "a.fst"));
}

TEST_F(OutputStream, ConverterThatIsKilledIsTold) {
  {
    const FakeProgram fake(directory_, "vcd2fst", "touch \"$2.hier\"; kill -9 $$");
    testbench::FstFile stream(directory_ / "a.fst");
    EXPECT_NE(failure_of([&] { stream.finish(); }).find("ended by signal 9"), std::string::npos);
  }
  EXPECT_TRUE(directory_is_empty());
}

TEST_F(OutputStream, FstThatIsCutShortIsTold) {
  if (!has_program("vcd2fst")) GTEST_SKIP() << "needs Debian's gtkwave";
  const fs::path real = directory_ / "real.fst";
  {
    testbench::FstFile stream(real);
    stream.write(some_vcd(20'000));
    stream.finish();
  }
  const FakeProgram fake(
      directory_, "vcd2fst",
      "cat > /dev/null; head -c $(($(wc -c < " + real.string() + ") - 20)) " + real.string() + " > \"$2\"");
  std::string failure;
  {
    testbench::FstFile stream(directory_ / "a.fst");
    stream.write("anything");
    failure = failure_of([&] { stream.finish(); });
  }
  EXPECT_NE(failure.find("cut short"), std::string::npos) << failure;
  EXPECT_FALSE(fs::exists(directory_ / "a.fst"));
}

}  // namespace output_stream_test
