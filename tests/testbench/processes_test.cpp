#include "testbench/system/processes.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/file.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>

#include "testbench/system/error.hpp"

namespace processes_test {

using testbench::InputError;
using testbench::run_in_processes;
using testbench::RunError;
using Job = std::function<std::string()>;
using Jobs = std::vector<Job>;

void sleep_milliseconds(int milliseconds) {
  std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
}

/// A file to which several processes append lines.
class Journal {
 public:
  Journal() {
    std::string pattern = testing::TempDir() + "processes_test_XXXXXX";
    close(mkstemp(pattern.data()));
    path_ = pattern;
  }
  ~Journal() { unlink(path_.c_str()); }
  void note(char what) const {
    const int file = open(path_.c_str(), O_WRONLY | O_APPEND);
    EXPECT_EQ(::write(file, &what, 1), 1);
    close(file);
  }
  std::string text() const {
    std::string text;
    std::getline(std::ifstream(path_), text, '\0');
    return text;
  }

 private:
  std::string path_;
};

TEST(Processes, ResultsComeInTheOrderOfTheJobs) {
  Jobs jobs;
  std::vector<std::string> expected;
  for (int i = 0; i < 12; ++i) {
    jobs.emplace_back([i] {
      sleep_milliseconds((12 - i) * 3);
      return "job " + std::to_string(i);
    });
    expected.push_back("job " + std::to_string(i));
  }
  for (const int at_once : {1, 3, 50}) EXPECT_EQ(run_in_processes(jobs, at_once), expected) << at_once;
}

TEST(Processes, NoJobsNoResults) {
  EXPECT_TRUE(run_in_processes({}, 4).empty());
}

TEST(Processes, EachJobHasAProcessOfItsOwn) {
  int mine = 1;
  const std::vector<std::string> results = run_in_processes(
      Jobs(3, [&mine] { return std::to_string(getpid()) + " " + std::to_string(mine++); }), 2);
  EXPECT_EQ(mine, 1);
  for (const std::string& result : results) {
    EXPECT_EQ(result.substr(result.find(' ')), " 1");
    EXPECT_NE(std::stoi(result), getpid());
  }
  EXPECT_NE(results[0], results[1]);
}

TEST(Processes, ResultsMayBeLongerThanAPipe) {
  const std::string long_text(3000000, 'x');
  const std::vector<std::string> results = run_in_processes(Jobs(4, [&] { return long_text; }), 4);
  for (const std::string& result : results) EXPECT_EQ(result.size(), long_text.size());
}

TEST(Processes, AtMostSoManyRunAtATime) {
  for (const int at_once : {1, 3}) {
    const Journal journal;
    run_in_processes(Jobs(9,
                          [&journal] {
                            journal.note('+');
                            sleep_milliseconds(40);
                            journal.note('-');
                            return std::string();
                          }),
                     at_once);
    int running = 0;
    int most = 0;
    for (const char step : journal.text()) {
      running += step == '+' ? 1 : -1;
      most = std::max(most, running);
    }
    EXPECT_EQ(running, 0);
    EXPECT_LE(most, at_once);
    EXPECT_EQ(most > 1, at_once > 1);
  }
}

TEST(Processes, SlowJobDoesNotHoldTheOthersBack) {
  const Journal journal;
  Jobs jobs(8, [&journal] {
    journal.note('x');
    return std::string();
  });
  jobs[0] = [&journal] {
    sleep_milliseconds(1000);
    journal.note('s');
    return std::string();
  };
  run_in_processes(jobs, 2);
  EXPECT_EQ(journal.text(), "xxxxxxxs");
}

TEST(Processes, TellsAfterEachJob) {
  std::vector<int> told;
  run_in_processes(Jobs(5, [] { return std::string("done"); }), 2,
                   [&](int finished) { told.push_back(finished); });
  EXPECT_EQ(told, (std::vector<int>{1, 2, 3, 4, 5}));
}

template <class Error>
void expect_error(const Job& failing, const std::string& message) {
  try {
    run_in_processes({[] { return std::string("fine"); }, failing}, 2);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.what(), message);
  }
}

TEST(Processes, ErrorsKeepTheirKind) {
  expect_error<InputError>([]() -> std::string { throw InputError("wrong size"); }, "wrong size");
  expect_error<RunError>([]() -> std::string { throw RunError("disk full"); }, "disk full");
  expect_error<RunError>([]() -> std::string { throw std::logic_error("odd"); }, "odd");
}

TEST(Processes, CrashIsAFailedRun) {
  const auto crash = []() -> std::string {
    raise(SIGKILL);
    return "survived";
  };
  expect_error<RunError>(crash, "a run ended without a result (signal or crash)");
}

TEST(Processes, NoJobStartsAfterAFailure) {
  const Journal journal;
  Jobs jobs(6, [&journal] {
    journal.note('x');
    return std::string();
  });
  jobs[1] = []() -> std::string { throw InputError("stop"); };
  EXPECT_THROW(run_in_processes(jobs, 1), InputError);
  EXPECT_EQ(journal.text(), "x");
}

TEST(Processes, OnlyRunningJobsEndBeforeTheErrorIsThrown) {
  const Journal journal;
  Jobs jobs(6, [&journal] {
    sleep_milliseconds(100);
    journal.note('x');
    return std::string();
  });
  jobs[0] = []() -> std::string { throw RunError("stop"); };
  EXPECT_THROW(run_in_processes(jobs, 3), RunError);
  EXPECT_EQ(journal.text(), "xx");
}

}  // namespace processes_test
