#include "testbench/sweep/point_store.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include "testbench/system/error.hpp"
#include "tests/support/temporary_directory.hpp"

namespace point_store_test {

using testbench::InputError;
using testbench::PointStore;
using testbench::RunError;

class PointStoreTest : public test_support::DirectoryFixture {
 protected:
  static PointStore::Json done(int cycles) { return {{"status", "done"}, {"cycles", cycles}}; }
  void append(const std::string& text) { std::ofstream(directory_ / "points.jsonl", std::ios::app) << text; }
};

TEST_F(PointStoreTest, KeepsWhatItWasGiven) {
  {
    PointStore store(directory_, "build");
    EXPECT_EQ(store.find("a"), nullptr);
    store.add("a", done(1));
    store.add("b", done(2));
    EXPECT_EQ((*store.find("a"))["cycles"], 1);
  }
  const PointStore store(directory_, "build");
  EXPECT_EQ((*store.find("b"))["cycles"], 2);
  EXPECT_EQ(store.find("c"), nullptr);
}

TEST_F(PointStoreTest, TheLaterOfTwoLinesCounts) {
  {
    PointStore store(directory_, "build");
    store.add("a", done(1));
    store.forget("a");
    EXPECT_EQ(store.find("a"), nullptr);
    store.add("a", done(3));
  }
  EXPECT_EQ((*PointStore(directory_, "build").find("a"))["cycles"], 3);
}

TEST_F(PointStoreTest, DropsALineThatAKillCutOff) {
  { PointStore(directory_, "build").add("a", done(1)); }
  append("{\"id\":\"b\",\"status\":\"do");
  {
    PointStore store(directory_, "build");
    EXPECT_NE(store.find("a"), nullptr);
    EXPECT_EQ(store.find("b"), nullptr);
    store.add("b", done(2));
  }
  EXPECT_EQ((*PointStore(directory_, "build").find("b"))["cycles"], 2);
}

TEST_F(PointStoreTest, AFullDiskLosesNothingThatWasFinished) {
  // A limit on the file's size stands in for a full disk: write() takes a part of the line, then fails.
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit old_limit{};
  getrlimit(RLIMIT_FSIZE, &old_limit);
  {
    PointStore store(directory_, "build");
    store.add("a", done(1));
    rlimit limit = old_limit;
    limit.rlim_cur = std::filesystem::file_size(store.path()) + 10;
    setrlimit(RLIMIT_FSIZE, &limit);
    EXPECT_THROW(store.add("b", done(2)), RunError);
    setrlimit(RLIMIT_FSIZE, &old_limit);
    EXPECT_EQ(store.find("b"), nullptr);
    store.add("c", done(3));
  }
  std::signal(SIGXFSZ, old_handler);
  const PointStore store(directory_, "build");
  EXPECT_NE(store.find("a"), nullptr);
  EXPECT_EQ(store.find("b"), nullptr);
  EXPECT_NE(store.find("c"), nullptr);
}

TEST_F(PointStoreTest, RefusesWhatIsNotItsOwn) {
  { PointStore(directory_, "build").add("a", done(1)); }
  EXPECT_THROW(PointStore(directory_, "another build"), InputError);
  append("{}\n");
  EXPECT_THROW(PointStore(directory_, "build"), InputError);
  std::ofstream(directory_ / "points.jsonl")
      << "{\"format\":\"csx600-sweep-points-0\",\"build\":\"build\"}\n";
  EXPECT_THROW(PointStore(directory_, "build"), InputError);
  std::ofstream(directory_ / "points.jsonl") << "hello\n";
  EXPECT_THROW(PointStore(directory_, "build"), InputError);
  EXPECT_THROW(PointStore("/proc/nowhere", "build"), InputError);
  std::ofstream(directory_ / "file") << "";
  EXPECT_THROW(PointStore(directory_ / "file", "build"), InputError);
}

TEST_F(PointStoreTest, IsOfOneProcessAtATime) {
  const PointStore store(directory_, "build");
  EXPECT_THROW(PointStore(directory_, "build"), InputError);
}

}  // namespace point_store_test
