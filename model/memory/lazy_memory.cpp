#include "model/memory/lazy_memory.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "model/memory/huge_pages.hpp"

namespace model {

LazyMemory::LazyMemory(std::uint64_t bytes)
    : size_bytes_(bytes), mapped_bytes_(bytes <= ~kHugePageBytes ? bytes + kHugePageBytes : bytes) {
  mapped_ = mmap(nullptr, mapped_bytes_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE,
                 -1, 0);
  if (mapped_ == MAP_FAILED)
    throw std::runtime_error("mono memory of " + std::to_string(bytes) +
                             " bytes: the host refused the address range");
  // From the start of a huge page: what the firmware uses most lies at low addresses.
  const auto address = reinterpret_cast<std::uintptr_t>(mapped_);
  data_ = static_cast<std::uint8_t*>(mapped_) + (kHugePageBytes - address % kHugePageBytes) % kHugePageBytes;
  prefer_huge_pages(data_, bytes);
}

LazyMemory::~LazyMemory() {
  munmap(mapped_, mapped_bytes_);
}

std::uint64_t LazyMemory::resident_bytes() const {
  const auto page_bytes = static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  std::vector<unsigned char> in_core((size_bytes_ + page_bytes - 1) / page_bytes);
  if (mincore(data_, size_bytes_, in_core.data()) != 0) return 0;
  const auto pages =
      std::count_if(in_core.begin(), in_core.end(), [](unsigned char page) { return page & 1; });
  return static_cast<std::uint64_t>(pages) * page_bytes;
}

}  // namespace model
