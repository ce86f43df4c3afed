#pragma once

#include <sys/types.h>

#include <functional>
#include <string>
#include <vector>

#include "testbench/system/error.hpp"

namespace testbench {

/// The caller wanted its jobs to stop.
class Interrupted : public RunError {
 public:
  Interrupted() : RunError("interrupted") {}
};

/// Runs each job in a process of its own, at most `at_once` at a time, and returns the jobs' results in the
/// order of `jobs`. SystemC elaborates once per process, so a command that makes several runs needs several
/// processes. If a job throws InputError or RunError, this function throws the same after all running jobs
/// have ended. `done` is called after each job.
/// @param limit_seconds a job that takes longer fails with RunError; 0: no limit
/// @param stop asked ten times a second; when it returns true, the running jobs are killed, and this
///     function throws Interrupted
std::vector<std::string> run_in_processes(const std::vector<std::function<std::string()>>& jobs, int at_once,
                                          const std::function<void(int finished)>& done = {},
                                          double limit_seconds = 0, const std::function<bool()>& stop = {});

/// Called in a child process: the operating system kills the child when `parent` ends, for whatever reason.
void end_with(pid_t parent);

}  // namespace testbench
