#include "firmware/cn/chip/poly_memory.hpp"

#include <cstdio>

namespace cn {

PolyMemory::PolyMemory(int num_pes, int bytes_per_pe)
    : num_pes_(num_pes),
      capacity_bytes_(bytes_per_pe - kReservedBytes),
      lines_a_strip_(std::size_t(bytes_per_pe / 8)),
      lines_(lines_a_strip_ * std::size_t((num_pes + kStripLanes - 1) / kStripLanes)) {}

int PolyMemory::used_bytes() const {
  return buffers_.empty() ? 0 : buffers_.back().span.offset_bytes + buffers_.back().span.size_bytes;
}

PolySpan PolyMemory::allocate(const std::string& name, int size_bytes) {
  const PolySpan span{used_bytes(), (size_bytes + 7) / 8 * 8};
  if (span.offset_bytes + span.size_bytes > capacity_bytes_) {
    throw PolyMemoryOverflow("poly SRAM overflow: buffer '" + name + "' needs " +
                                 std::to_string(span.size_bytes) + " bytes a PE, " +
                                 std::to_string(capacity_bytes_ - span.offset_bytes) + " of " +
                                 std::to_string(capacity_bytes_) + " are free",
                             map());
  }
  buffers_.push_back({name, span});
  return span;
}

std::string PolyMemory::map() const {
  std::string text = "  offset   bytes  buffer\n";
  const auto add_line = [&](int offset_bytes, int size_bytes, const std::string& name) {
    char numbers[32];
    std::snprintf(numbers, sizeof(numbers), "%8d%8d  ", offset_bytes, size_bytes);
    text += numbers + name + '\n';
  };
  for (const Buffer& buffer : buffers_)
    add_line(buffer.span.offset_bytes, buffer.span.size_bytes, buffer.name);
  add_line(used_bytes(), capacity_bytes_ - used_bytes(), "(free)");
  add_line(capacity_bytes_, kReservedBytes, "(PE number, reserved by the ABI)");
  return text;
}

}  // namespace cn
