#pragma once

#include <cstdint>

namespace model {

struct HostLinkStatistics {
  std::uint64_t bytes_uploaded = 0;
  std::uint64_t bytes_downloaded = 0;
  std::uint64_t transfers = 0;
  std::uint64_t busy_cycles = 0;
};

}  // namespace model
