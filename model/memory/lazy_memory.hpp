#pragma once

#include <cstdint>

namespace model {

/// Zeroed memory of which the host provides only the pages that are touched.
class LazyMemory {
 public:
  /// Throws std::runtime_error when the host refuses the address range.
  explicit LazyMemory(std::uint64_t bytes);
  ~LazyMemory();
  LazyMemory(const LazyMemory&) = delete;
  LazyMemory& operator=(const LazyMemory&) = delete;

  std::uint8_t* data() { return data_; }
  const std::uint8_t* data() const { return data_; }
  std::uint64_t size_bytes() const { return size_bytes_; }
  /// Bytes of host memory in use.
  std::uint64_t resident_bytes() const;

 private:
  std::uint64_t size_bytes_;
  std::uint64_t mapped_bytes_;
  void* mapped_;
  std::uint8_t* data_;  ///< within what is mapped
};

}  // namespace model
