#pragma once

#include <cstdint>

namespace model {

struct PolySramStatistics {
  std::uint64_t words_in = 0;   ///< 8-byte words written by programmed I/O, in all PEs
  std::uint64_t words_out = 0;  ///< read by it
  std::uint64_t port_cycles =
      0;               ///< that programmed I/O took the ports; how many a kernel loses: stolen_cycles.hpp
  int peak_bytes = 0;  ///< of one PE
};

}  // namespace model
