#include "testbench/system/ranks.hpp"

#include <cstdlib>

namespace testbench {

int launched_processes() {
  for (const char* const name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"})
    if (const char* const value = std::getenv(name)) return std::atoi(value);
  return 1;
}

/// Messages are few and small, so rank 0 collects all parts and sends them to all ranks.
std::vector<std::string> Ranks::exchange(const std::string& bytes) {
  std::vector<std::string> all(std::size_t(size_), bytes);
  if (alone()) return all;
  if (!is_first()) {
    send(0, bytes);
    for (std::string& part : all) part = receive().bytes;
    return all;
  }
  for (int others = 1; others < size_; ++others) {
    Message message = receive();
    all[std::size_t(message.from)] = std::move(message.bytes);
  }
  for (int to = 1; to < size_; ++to)
    for (const std::string& part : all) send(to, part);
  return all;
}

}  // namespace testbench
