#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

namespace testbench {

/// The processes that one `mpirun` started, possibly on several machines. A process started without `mpirun`
/// is the only rank. Built from ranks_mpi.cpp where MPI is installed, else from ranks_alone.cpp.
class Ranks {
 public:
  struct Message {
    int from = 0;
    std::string bytes;
  };

  /// Joins the other ranks; at most one object per process. Throws InputError when several ranks were started
  /// and this build has no MPI.
  Ranks();
  /// Leaves the other ranks and waits until all of them have left.
  ~Ranks();  // NOLINT(performance-trivially-destructible): not trivial with MPI
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

  int rank() const { return rank_; }
  int size() const { return size_; }
  bool alone() const { return size_ == 1; }
  bool is_first() const { return rank_ == 0; }

  void send(int to, const std::string& bytes);
  /// Waits for a message from any rank.
  Message receive();
  /// Returns std::nullopt if no message has arrived.
  std::optional<Message> try_receive();
  /// Whether any rank was interrupted (InterruptGuard). The rank that was tells the others. In a process that
  /// a rank has started: whether that process was.
  bool stop_requested();
  /// Ends the processes of all ranks.
  [[noreturn]] void abort(int exit_code);

  /// Must be called by all ranks. Each gets the bytes of every rank, by rank.
  std::vector<std::string> exchange(const std::string& bytes);

 private:
  int rank_ = 0;
  int size_ = 1;
  pid_t process_ = 0;         ///< of the rank; one that it has started may not call MPI
  bool is_stopping_ = false;  ///< all ranks know
};

/// The number of processes that the launcher reports (Open MPI, PMI); 1 without a launcher.
int launched_processes();

}  // namespace testbench
