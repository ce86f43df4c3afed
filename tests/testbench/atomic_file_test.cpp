// Files that appear whole or not at all, and what a killed process leaves of them.

#include "testbench/files/atomic_file.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <fstream>

#include "testbench/files/file_identity.hpp"
#include "testbench/system/error.hpp"

namespace atomic_file_test {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

class AtomicFile : public testing::Test {
 protected:
  AtomicFile() {
    std::string pattern = testing::TempDir() + "csx600_atomic_XXXXXX";
    directory_ = mkdtemp(pattern.data());
  }
  ~AtomicFile() override { fs::remove_all(directory_); }

  fs::path in(const std::string& name) const { return directory_ / name; }
  void touch(const std::string& name) const { std::ofstream(in(name)) << "x"; }
  Names names() const {
    Names found;
    for (const auto& entry : fs::directory_iterator(directory_)) found.push_back(entry.path().filename());
    std::sort(found.begin(), found.end());
    return found;
  }

 private:
  fs::path directory_;
};

TEST_F(AtomicFile, WhatAKilledProcessLeftIsRemovedByTheNext) {
  const pid_t child = fork();
  if (child == 0) {
    const testbench::TemporaryFile file(in("a.exr"));
    raise(SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_EQ(names(), Names{".a.exr.csx600." + std::to_string(child) + ".0.tmp"});
  touch(names().front() + ".hier");  // of the converter that writes .fst
  testbench::write_bytes_atomically(in("a.exr"), "new");
  EXPECT_EQ(names(), Names{"a.exr"});
}

TEST_F(AtomicFile, FilesOfOthersStay) {
  const Names others = {".a.exr.csx600..0.tmp",   ".a.exr.csx600.1.0.tmp.hier",
                        ".a.exr.csx600.1.tmp",    ".a.exr.csx600.1.x.tmp",
                        ".a.exr.csx600.1.0.tmp~", ".b.exr.csx600.1.0.tmp",
                        ".xa.exr.csx600.1.0.tmp", ".a.exr.1.0.tmp",
                        "a.exr.csx600.1.0.tmp"};
  for (const std::string& name : others) touch(name);
  fs::create_directory(in(".a.exr.csx600.7.0.tmp"));
  fs::create_symlink("a.exr", in(".a.exr.csx600.8.0.tmp"));
  const Names before = names();
  testbench::require_writable(in("a.exr"));
  EXPECT_EQ(names(), before);
}

TEST_F(AtomicFile, AFileInUseStays) {
  testbench::TemporaryFile in_use(in("a.exr"));
  const testbench::TemporaryFile another(in("a.exr"));
  EXPECT_NE(in_use.path(), another.path());
  EXPECT_TRUE(fs::exists(in_use.path()));
  in_use.rename_to(in("a.exr"));
  EXPECT_TRUE(fs::exists(another.path()));
}

TEST_F(AtomicFile, FilesOfASetAreWrittenTogetherOrNotAtAll) {
  fs::create_directory(in("b"));
  EXPECT_THROW(testbench::write_together({{in("a"), "1"}, {in("b"), "2"}}), testbench::InputError);
  EXPECT_EQ(names(), Names{"b"});
  testbench::write_together({{in("a"), "1"}, {in("c"), "2"}});
  EXPECT_EQ(names(), (Names{"a", "b", "c"}));
}

TEST_F(AtomicFile, IdentityDoesNotDependOnTheSpelling) {
  using testbench::FileIdentity;
  fs::create_directory(in("d"));
  fs::create_directory_symlink("d", in("link"));
  touch("d/old");
  fs::create_hard_link(in("d/old"), in("hard"));
  fs::create_symlink("d/old", in("soft"));
  for (const char* name : {"link/old", "d/./old", "d/../link/old", "hard", "soft"})
    EXPECT_TRUE(FileIdentity(in(name)) == FileIdentity(in("d/old"))) << name;
  for (const char* name : {"link/new", "d/./new", "link/../link/new"})
    EXPECT_TRUE(FileIdentity(in(name)) == FileIdentity(in("d/new"))) << name;
  EXPECT_FALSE(FileIdentity(in("d/new")) == FileIdentity(in("new")));
  EXPECT_FALSE(FileIdentity(in("d/old")) == FileIdentity(in("d/new")));
}

}  // namespace atomic_file_test
