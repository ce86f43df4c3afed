#pragma once

#include <cstdint>

namespace model {

struct PolySramStatistics {
  std::uint64_t words_in = 0;   ///< 8-byte words written by programmed I/O, in all PEs
  std::uint64_t words_out = 0;  ///< 8-byte words read by programmed I/O, in all PEs
  std::uint64_t port_cycles =
      0;  ///< port cycles taken by programmed I/O; stolen_cycles.hpp says how many a kernel loses
  int peak_bytes = 0;  ///< most bytes in use in a PE
};

}  // namespace model
