// Ranks with MPI, through its C interface, with one thread and two message tags.

#include <mpi.h>
#include <unistd.h>

#include <cstdlib>

#include "testbench/system/interrupt.hpp"
#include "testbench/system/ranks.hpp"

namespace testbench {
namespace {

constexpr int kTag = 0;
constexpr int kStopTag = 1;  ///< of an empty message: the sender was interrupted

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
  process_ = getpid();
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
  constexpr useconds_t kPollMicroseconds = 100;
  while (true) {
    if (std::optional<Message> message = try_receive()) return std::move(*message);
    stop_requested();
    usleep(kPollMicroseconds);
  }
}

std::optional<Ranks::Message> Ranks::try_receive() {
  if (alone()) return std::nullopt;
  int arrived = 0;
  MPI_Status status;
  MPI_Iprobe(MPI_ANY_SOURCE, kTag, MPI_COMM_WORLD, &arrived, &status);
  return arrived != 0 ? std::optional(take(status)) : std::nullopt;
}

bool Ranks::stop_requested() {
  if (alone() || getpid() != process_) return interrupt_requested();
  if (is_stopping_) return true;
  int is_told = 0;
  MPI_Iprobe(MPI_ANY_SOURCE, kStopTag, MPI_COMM_WORLD, &is_told, MPI_STATUS_IGNORE);
  is_stopping_ = is_told != 0 || interrupt_requested();
  if (!is_stopping_ || is_told != 0) return is_stopping_;
  for (int to = 0; to < size_; ++to)
    if (to != rank_) MPI_Send(nullptr, 0, MPI_CHAR, to, kStopTag, MPI_COMM_WORLD);
  return true;
}

void Ranks::abort(int exit_code) {
  if (!alone()) MPI_Abort(MPI_COMM_WORLD, exit_code);
  std::_Exit(exit_code);
}

}  // namespace testbench
