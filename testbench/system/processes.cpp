#include "testbench/system/processes.hpp"

#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <map>
#include <new>
#include <optional>

#include "testbench/system/descriptor.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/time_limit.hpp"

namespace testbench {
namespace {

enum Status : int { succeeded = 0, run_error = 1, input_error = 2 };

struct Child {
  std::size_t job;
  int pipe;
};

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

[[noreturn]] void run_child(const std::function<std::string()>& job, int pipe, double limit_seconds) {
  std::optional<TimeLimit> limit;
  limit.emplace(limit_seconds, [pipe](const std::string& message) {
    write_all(pipe, message);
    _exit(run_error);
  });
  Status status = succeeded;
  std::string text;
  try {
    text = job();
  } catch (const InputError& error) {
    status = input_error;
    text = error.details().empty() ? error.what() : error.what() + ("\n" + error.details());
  } catch (const std::bad_alloc&) {
    status = run_error;
    text = kOutOfMemory;
  } catch (const std::exception& error) {
    status = run_error;
    text = error.what();
  }
  limit.reset();
  if (write_all(pipe, text) != 0) status = run_error;
  close(pipe);
  _exit(status);
}

using Children = std::map<pid_t, Child>;

/// Kills the children, whose results nobody will read, and throws Interrupted.
[[noreturn]] void stop_all(const Children& running) {
  for (const auto& [child, info] : running) {
    kill(child, SIGKILL);
    close(info.pipe);
    waitpid(child, nullptr, 0);
  }
  throw Interrupted();
}

/// Waits until a child writes its result or ends.
Children::const_iterator first_with_result(const Children& running, const std::function<bool()>& stop) {
  constexpr int kPollMilliseconds = 100;
  std::vector<pollfd> pipes;
  for (const auto& [child, info] : running) pipes.push_back({info.pipe, POLLIN, 0});
  while (true) {
    const int ready = poll(pipes.data(), pipes.size(), stop ? kPollMilliseconds : -1);
    if (ready > 0 || (ready < 0 && errno != EINTR)) break;
    if (stop && stop()) stop_all(running);
  }
  auto found = running.begin();
  for (const pollfd& pipe : pipes) {
    if (pipe.revents != 0) break;
    ++found;
  }
  return found != running.end() ? found : running.begin();
}

std::pair<pid_t, int> start_child(const std::function<std::string()>& job, double limit_seconds) {
  int ends[2];
  if (pipe(ends) != 0) throw RunError("cannot make a pipe: " + system_message(errno));
  std::fflush(nullptr);
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child < 0) throw RunError("cannot start a process: " + system_message(errno));
  if (child == 0) {
    end_with(parent);
    close(ends[0]);
    run_child(job, ends[1], limit_seconds);
  }
  close(ends[1]);
  return {child, ends[0]};
}

}  // namespace

void end_with(pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(run_error);  // the parent ended before this call
}

std::vector<std::string> run_in_processes(const std::vector<std::function<std::string()>>& jobs, int at_once,
                                          const std::function<void(int finished)>& done, double limit_seconds,
                                          const std::function<bool()>& stop) {
  std::vector<std::string> results(jobs.size());
  Children running;
  std::size_t next = 0;
  int finished = 0;
  int failure = succeeded;
  std::string failure_text;
  while (!running.empty() || (next < jobs.size() && failure == succeeded)) {
    while (failure == succeeded && next < jobs.size() && running.size() < std::size_t(at_once)) {
      const auto [child, pipe] = start_child(jobs[next], limit_seconds);
      running[child] = {next++, pipe};
    }
    // A result may be longer than a pipe's buffer, so it is read before the child can end, and reaped then.
    const auto [child, info] = *first_with_result(running, stop);
    std::string text = read_all(info.pipe);
    close(info.pipe);
    int status = 0;
    waitpid(child, &status, 0);
    running.erase(child);
    if (!WIFEXITED(status) || WEXITSTATUS(status) != succeeded) {
      failure = WIFEXITED(status) ? WEXITSTATUS(status) : run_error;
      failure_text = text.empty() ? "a run ended without a result (signal or crash)" : text;
      continue;
    }
    results[info.job] = std::move(text);
    if (done) done(++finished);
  }
  if (failure == input_error) {
    const std::size_t end = failure_text.find('\n');
    throw InputError(failure_text.substr(0, end),
                     end == std::string::npos ? "" : failure_text.substr(end + 1));
  }
  if (failure != succeeded) throw RunError(failure_text);
  return results;
}

}  // namespace testbench
