#include "testbench/system/workers.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>

#include "testbench/system/descriptor.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/processes.hpp"

namespace testbench {
namespace {

/// Returns false when the other side has closed the socket.
bool receive_all(int socket, char* bytes, std::size_t count) {
  while (count > 0) {
    const ssize_t received = recv(socket, bytes, count, 0);
    if (received < 0 && errno == EINTR) continue;
    if (received <= 0) return false;
    bytes += received;
    count -= std::size_t(received);
  }
  return true;
}

/// A message is its length in 8 bytes, then its bytes.
bool send_message(int socket, const std::string& text) {
  const std::uint64_t bytes = text.size();
  return send_all(socket, {reinterpret_cast<const char*>(&bytes), sizeof(bytes)}) == 0 &&
         send_all(socket, text) == 0;
}

std::optional<std::string> receive_message(int socket) {
  std::uint64_t bytes = 0;
  if (!receive_all(socket, reinterpret_cast<char*>(&bytes), sizeof(bytes))) return std::nullopt;
  std::string text(bytes, '\0');
  return receive_all(socket, text.data(), bytes) ? std::optional(std::move(text)) : std::nullopt;
}

/// A worker ignores signals that ask it to stop; the first process decides when workers end.
[[noreturn]] void serve(int socket, const Workers::MakeAnswer& make_answer) {
  std::signal(SIGINT, SIG_IGN);
  std::signal(SIGTERM, SIG_IGN);
  const Workers::Answer answer = make_answer();
  while (const std::optional<std::string> order = receive_message(socket))
    if (!send_message(socket, answer(*order))) break;
  _exit(0);
}

}  // namespace

Workers::Workers(int count, MakeAnswer make_answer)
    : make_answer_(std::move(make_answer)), workers_(std::size_t(count)) {
  for (Worker& worker : workers_) start(worker);
}

Workers::~Workers() {
  for (Worker& worker : workers_) stop(worker);
}

void Workers::start(Worker& worker) {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    throw RunError("cannot make a socket: " + system_message(errno));
  std::fflush(nullptr);
  const pid_t parent = getpid();
  worker.process = fork();
  if (worker.process < 0) throw RunError("cannot start a process: " + system_message(errno));
  if (worker.process == 0) {
    end_with(parent);
    close(ends[0]);
    serve(ends[1], make_answer_);
  }
  close(ends[1]);
  worker.socket = ends[0];
}

void Workers::stop(Worker& worker) {
  if (worker.process <= 0) return;
  kill(worker.process, SIGKILL);
  close(worker.socket);
  while (waitpid(worker.process, nullptr, 0) < 0 && errno == EINTR) {
  }
  worker.process = -1;
}

void Workers::send(int worker, const std::string& order) {
  // A failure is not handled here: next() finds that the worker has ended when it reads the reply.
  send_message(workers_[std::size_t(worker)].socket, order);
}

std::optional<Workers::Reply> Workers::next(int milliseconds) {
  std::vector<pollfd> sockets;
  for (const Worker& worker : workers_) sockets.push_back({worker.socket, POLLIN, 0});
  if (poll(sockets.data(), sockets.size(), milliseconds) <= 0) return std::nullopt;
  for (std::size_t i = 0; i < sockets.size(); ++i) {
    if (sockets[i].revents == 0) continue;
    Reply reply{static_cast<int>(i), receive_message(workers_[i].socket)};
    if (!reply.text) {
      stop(workers_[i]);
      start(workers_[i]);
    }
    return reply;
  }
  return std::nullopt;
}

}  // namespace testbench
