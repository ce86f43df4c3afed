#pragma once

#include <sys/types.h>

#include <functional>
#include <string>
#include <vector>

namespace testbench {

/// Runs each job in a process of its own, at most `at_once` at a time, and returns what the jobs returned, in
/// order. SystemC elaborates once a process, so this is how one command makes several runs. A job that throws
/// InputError or RunError makes this throw the same once all running jobs have ended; `done` is told after
/// each job.
std::vector<std::string> run_in_processes(const std::vector<std::function<std::string()>>& jobs, int at_once,
                                          const std::function<void(int finished)>& done = {});

/// In a child process: from now on it is killed when `parent` ends, however that ends.
void end_with(pid_t parent);

}  // namespace testbench
