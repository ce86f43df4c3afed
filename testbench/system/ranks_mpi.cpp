// Ranks with MPI, through its C interface, with one thread and one message tag.

#include <mpi.h>

#include <cstdlib>

#include "testbench/system/ranks.hpp"

namespace testbench {
namespace {

constexpr int kTag = 0;

Ranks::Message take(const MPI_Status& status) {
  int bytes = 0;
  MPI_Get_count(&status, MPI_CHAR, &bytes);
  Ranks::Message message{status.MPI_SOURCE, std::string(std::size_t(bytes), '\0')};
  MPI_Recv(message.bytes.data(), bytes, MPI_CHAR, status.MPI_SOURCE, kTag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  return message;
}

}  // namespace

/// Without a launcher MPI is not initialised, because MPI_Init would search for one, which takes long.
Ranks::Ranks() {
  if (launched_processes() <= 1) return;
  MPI_Init(nullptr, nullptr);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
}

Ranks::~Ranks() {
  int initialised = 0;
  MPI_Initialized(&initialised);
  if (initialised != 0) MPI_Finalize();
}

void Ranks::send(int to, const std::string& bytes) {
  MPI_Send(bytes.data(), static_cast<int>(bytes.size()), MPI_CHAR, to, kTag, MPI_COMM_WORLD);
}

Ranks::Message Ranks::receive() {
  MPI_Status status;
  MPI_Probe(MPI_ANY_SOURCE, kTag, MPI_COMM_WORLD, &status);
  return take(status);
}

std::optional<Ranks::Message> Ranks::try_receive() {
  if (alone()) return std::nullopt;
  int arrived = 0;
  MPI_Status status;
  MPI_Iprobe(MPI_ANY_SOURCE, kTag, MPI_COMM_WORLD, &arrived, &status);
  return arrived != 0 ? std::optional(take(status)) : std::nullopt;
}

void Ranks::abort(int exit_code) {
  if (!alone()) MPI_Abort(MPI_COMM_WORLD, exit_code);
  std::_Exit(exit_code);
}

}  // namespace testbench
