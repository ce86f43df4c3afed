#pragma once

#include <sys/types.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace testbench {

/// Processes that answer orders, each one order at a time, and keep state from one order to the next. They
/// end when this process ends, for whatever reason.
class Workers {
 public:
  using Answer = std::function<std::string(const std::string& order)>;
  using MakeAnswer = std::function<Answer()>;  ///< called once in each worker

  struct Reply {
    int worker = 0;
    std::optional<std::string>
        text;  ///< std::nullopt: the worker crashed during its order and was replaced by a new one
  };

  /// Throws RunError when a process cannot be started.
  Workers(int count, MakeAnswer make_answer);
  /// Kills all workers.
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  /// Sends an order to a worker that has replied to its last one.
  void send(int worker, const std::string& order);
  /// The next reply; std::nullopt if none arrives within `milliseconds`.
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
