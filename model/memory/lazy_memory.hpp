#pragma once

#include <cstdint>

namespace model {

/// Zeroed memory. The operating system provides only the pages that are touched.
class LazyMemory {
 public:
  /// Throws std::runtime_error when the operating system refuses the address range.
  explicit LazyMemory(std::uint64_t bytes);
  ~LazyMemory();
  LazyMemory(const LazyMemory&) = delete;
  LazyMemory& operator=(const LazyMemory&) = delete;

  std::uint8_t* data() { return data_; }
  const std::uint8_t* data() const { return data_; }
  std::uint64_t size_bytes() const { return size_bytes_; }
  /// Bytes of the simulator's memory in use.
  std::uint64_t resident_bytes() const;

 private:
  std::uint64_t size_bytes_;
  std::uint64_t mapped_bytes_;
  void* mapped_;
  std::uint8_t* data_;  ///< within the mapped range
};

}  // namespace model
