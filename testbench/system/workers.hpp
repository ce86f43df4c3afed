#pragma once

#include <sys/types.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace testbench {

/// Processes that answer orders, one at a time each, and keep what they need from one order to the next. They
/// end with this process, whatever ends it.
class Workers {
 public:
  using Answer = std::function<std::string(const std::string& order)>;
  using MakeAnswer = std::function<Answer()>;  ///< called in each worker, once

  struct Reply {
    int worker = 0;
    std::optional<std::string> text;  ///< nothing: it crashed over its order, and another takes its place
  };

  /// Throws RunError when there is no process to be had.
  Workers(int count, MakeAnswer make_answer);
  /// Kills them.
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  /// To a worker that has replied to its last order.
  void send(int worker, const std::string& order);
  /// The next reply; nothing if none comes for that long.
  std::optional<Reply> next(int milliseconds);

 private:
  struct Worker {
    pid_t process = -1;
    int socket = -1;
  };

  void start(Worker& worker);
  static void stop(Worker& worker);

  MakeAnswer make_answer_;
  std::vector<Worker> workers_;
};

}  // namespace testbench
