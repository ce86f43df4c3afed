#include "testbench/processes.hpp"

#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>

#include "testbench/error.hpp"

namespace testbench {
namespace {

enum Status : int { succeeded = 0, run_error = 1, input_error = 2 };

void write_all(int pipe, const std::string& text) {
  std::size_t written = 0;
  while (written < text.size()) {
    const ssize_t count = write(pipe, text.data() + written, text.size() - written);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    written += std::size_t(count);
  }
}

std::string read_all(int pipe) {
  std::string text;
  char buffer[4096];
  while (true) {
    const ssize_t count = read(pipe, buffer, sizeof(buffer));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    text.append(buffer, std::size_t(count));
  }
  return text;
}

[[noreturn]] void run_child(const std::function<std::string()>& job, int pipe) {
  Status status = succeeded;
  std::string text;
  try {
    text = job();
  } catch (const InputError& error) {
    status = input_error;
    text = error.what();
  } catch (const std::exception& error) {
    status = run_error;
    text = error.what();
  }
  write_all(pipe, text);
  close(pipe);
  _exit(status);
}

ProcessPool::End end_of(int status) {
  if (WIFEXITED(status) && WEXITSTATUS(status) == succeeded) return ProcessPool::End::done;
  return WIFEXITED(status) && WEXITSTATUS(status) == input_error ? ProcessPool::End::input_error
                                                                 : ProcessPool::End::run_error;
}

}  // namespace

ProcessPool::~ProcessPool() {
  for (const auto& [child, info] : running_) {
    kill(child, SIGKILL);
    close(info.pipe);
    waitpid(child, nullptr, 0);
  }
}

void ProcessPool::start(int job, const std::function<std::string()>& work) {
  int ends[2];
  if (pipe(ends) != 0) throw RunError(std::string("cannot make a pipe: ") + std::strerror(errno));
  std::fflush(nullptr);
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child < 0) throw RunError(std::string("cannot start a process: ") + std::strerror(errno));
  if (child == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(run_error);  // it died before it could be asked for
    close(ends[0]);
    run_child(work, ends[1]);
  }
  close(ends[1]);
  running_[child] = {job, ends[0]};
}

std::optional<ProcessPool::Result> ProcessPool::next(int milliseconds) {
  std::vector<pollfd> pipes;
  for (const auto& [child, info] : running_) pipes.push_back({info.pipe, POLLIN, 0});
  if (pipes.empty() || poll(pipes.data(), pipes.size(), milliseconds) <= 0) return std::nullopt;
  auto found = running_.begin();
  for (const pollfd& pipe : pipes) {
    if (pipe.revents != 0) break;
    ++found;
  }
  const auto [child, info] = *found;
  // A result may be longer than a pipe's buffer, so it is read before the child can end, and reaped then.
  Result result{info.job, End::done, read_all(info.pipe)};
  close(info.pipe);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  running_.erase(found);
  result.end = end_of(status);
  if (result.end != End::done && result.text.empty())
    result.text = "a run ended without a result (signal or crash)";
  return result;
}

std::vector<std::string> run_in_processes(const std::vector<std::function<std::string()>>& jobs, int at_once,
                                          const std::function<void(int finished)>& done) {
  std::vector<std::string> results(jobs.size());
  ProcessPool pool;
  std::size_t next = 0;
  int finished = 0;
  ProcessPool::Result failure;
  while (pool.running() > 0 || (next < jobs.size() && failure.end == ProcessPool::End::done)) {
    for (; failure.end == ProcessPool::End::done && next < jobs.size() && pool.running() < at_once; ++next)
      pool.start(static_cast<int>(next), jobs[next]);
    std::optional<ProcessPool::Result> result = pool.next();
    if (!result) continue;  // a signal
    if (result->end != ProcessPool::End::done) {
      failure = std::move(*result);
      continue;
    }
    results[std::size_t(result->job)] = std::move(result->text);
    if (done) done(++finished);
  }
  if (failure.end == ProcessPool::End::input_error) throw InputError(failure.text);
  if (failure.end != ProcessPool::End::done) throw RunError(failure.text);
  return results;
}

}  // namespace testbench
