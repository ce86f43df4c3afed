#include "testbench/sweep/point_store.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include "testbench/system/error.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/temporary_directory.hpp"

namespace point_store_test {

using testbench::InputError;
using testbench::PointStore;
using testbench::RunError;

class PointStoreTest : public test_support::DirectoryFixture {
 protected:
  /// The line of a point; a failed one needs no statistics.
  static PointStore::Json done(int cycles) {
    return {{"status", "failed"}, {"error", "full"}, {"cycles", cycles}};
  }
  /// The message of the InputError of a store that holds `lines` behind its first.
  std::string refusal(const std::string& lines) {
    std::ofstream(directory_ / "points.jsonl")
        << "{\"format\":\"csx600-sweep-points-2\",\"build\":\"build\"}\n"
        << lines;
    return test_support::input_error_of([&] { PointStore(directory_, "build"); });
  }
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

TEST_F(PointStoreTest, LinesAreCheckedBeforeAnythingIsWritten) {
  const std::string place = (directory_ / "points.jsonl").string() + ":3: ";
  const std::string good = "{\"id\":\"a\",\"status\":\"failed\",\"error\":\"full\"}\n";
  const std::string cut_off = "{\"id\":\"b\",";
  for (
      const auto& [line, message] : std::vector<std::pair<std::string, std::string>>{
          {R"({"id":"a"})", "status: found none; allowed: a text"},
          {R"({"id":7,"status":"done"})", "id: found 7; allowed: a text"},
          {R"({"id":"a","status":"lost"})", "status: found 'lost'; allowed: 'done', 'failed'"},
          {R"({"id":"a","status":"failed"})", "error: found none; allowed: a text"},
          {R"({"id":"a","status":"done","how":"full","audited":1})",
           "audited: found 1; allowed: true or false"},
          {R"({"id":"a","status":"done","how":"full","audited":false,"simulator_cpu_seconds":1,"statistics":{}})",
           "statistics: scene: missing; allowed is a whole statistics file"},
          {R"({"id":"a","status":"done","how":"full","audited":false,"simulator_cpu_seconds":1,"statistics":[]})",
           "statistics: found a list; allowed: an object"}}) {
    EXPECT_EQ(refusal(good + line + "\n" + cut_off), place + message);
    EXPECT_NE(read("points.jsonl").find(cut_off), std::string::npos) << "shortened";
  }
  EXPECT_NE(refusal(good + std::string(100'000, '[') + "\n").find(place + "found values nested"),
            std::string::npos);
}

TEST_F(PointStoreTest, IsOfOneProcessAtATime) {
  const PointStore store(directory_, "build");
  EXPECT_THROW(PointStore(directory_, "build"), InputError);
}

}  // namespace point_store_test
