#pragma once

#include <sys/types.h>

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace testbench {

/// Jobs, each in a process of its own: SystemC elaborates once a process, so this is how one command makes
/// several runs. The processes end with this one, whatever ends it.
class ProcessPool {
 public:
  enum class End : std::uint8_t { done, run_error, input_error };
  struct Result {
    int job = 0;
    End end = End::done;
    std::string text;  ///< what the job returned, or what() of what it threw
  };

  ProcessPool() = default;
  ProcessPool(const ProcessPool&) = delete;
  ProcessPool& operator=(const ProcessPool&) = delete;
  /// Kills those that still run.
  ~ProcessPool();

  /// Throws RunError when there is no process to be had.
  void start(int job, const std::function<std::string()>& work);
  int running() const { return static_cast<int>(running_.size()); }
  /// The next job to end; nothing when none runs or none ends for that long (-1: for ever).
  std::optional<Result> next(int milliseconds = -1);

 private:
  struct Child {
    int job;
    int pipe;
  };
  std::map<pid_t, Child> running_;
};

/// Runs each job in a process of its own, at most `at_once` at a time, and returns what the jobs returned, in
/// order. A job that throws
/// InputError or RunError makes this throw the same once all running jobs have ended; `done` is told after
/// each job.
std::vector<std::string> run_in_processes(const std::vector<std::function<std::string()>>& jobs, int at_once,
                                          const std::function<void(int finished)>& done = {});

}  // namespace testbench
