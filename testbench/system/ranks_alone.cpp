// Ranks for a build without MPI: one rank.

#include <cstdlib>

#include "testbench/system/error.hpp"
#include "testbench/system/interrupt.hpp"
#include "testbench/system/ranks.hpp"

namespace testbench {

Ranks::Ranks() {
  if (launched_processes() > 1)
    throw InputError("mpirun: found " + std::to_string(launched_processes()) +
                     " processes; allowed: one, since this csx600 was built without MPI");
}

Ranks::~Ranks() = default;

void Ranks::send(int, const std::string&) {}

Ranks::Message Ranks::receive() {
  throw RunError("found a wait for a message, but there is only one rank");
}

std::optional<Ranks::Message> Ranks::try_receive() {
  return std::nullopt;
}

bool Ranks::stop_requested() {
  is_stopping_ = is_stopping_ || interrupt_requested();
  return is_stopping_;
}

void Ranks::abort(int exit_code) {
  std::_Exit(exit_code);
}

}  // namespace testbench
