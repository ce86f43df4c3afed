#pragma once

#include <optional>
#include <string>
#include <vector>

namespace testbench {

/// The processes that one `mpirun` started, which may be on several machines; a plain start is one rank.
/// Built with MPI where it is installed (ranks_mpi.cpp), else without (ranks_alone.cpp).
class Ranks {
 public:
  struct Message {
    int from = 0;
    std::string bytes;
  };

  /// Joins the others. Once a process. Throws InputError when several were started and this build has no MPI.
  Ranks();
  /// Leaves; waits for all others to do so.
  ~Ranks();  // NOLINT(performance-trivially-destructible): with MPI it does something
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

  int rank() const { return rank_; }
  int size() const { return size_; }
  bool alone() const { return size_ == 1; }
  bool is_first() const { return rank_ == 0; }

  void send(int to, const std::string& bytes);
  /// Of any rank; waits for one.
  Message receive();
  /// Nothing if none has arrived.
  std::optional<Message> try_receive();
  /// Ends the processes of all ranks.
  [[noreturn]] void abort(int exit_code);

  /// All ranks call it; each gets what each gave, by rank.
  std::vector<std::string> exchange(const std::string& bytes);

 private:
  int rank_ = 0;
  int size_ = 1;
};

/// How many processes a launcher says that it started (Open MPI, PMI); 1 if none does.
int launched_processes();

}  // namespace testbench
