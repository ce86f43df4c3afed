#include "firmware/cn/poly_memory.hpp"

#include <cstdio>

namespace cn {

PolyMemory::PolyMemory(int num_pes, int bytes_per_pe)
    : num_pes_(num_pes),
      capacity_bytes_(bytes_per_pe - kReservedBytes),
      words_(std::size_t(bytes_per_pe / 8) * std::size_t(num_pes)) {}

int PolyMemory::used_bytes() const {
  return buffers_.empty() ? 0 : buffers_.back().span.offset_bytes + buffers_.back().span.size_bytes;
}

PolySpan PolyMemory::allocate(const std::string& name, int size_bytes) {
  const PolySpan span{used_bytes(), (size_bytes + 7) / 8 * 8};
  if (span.offset_bytes + span.size_bytes > capacity_bytes_) {
    throw PolyMemoryOverflow("poly SRAM overflow: buffer '" + name + "' needs " + std::to_string(span.size_bytes) +
                                 " bytes a PE, " + std::to_string(capacity_bytes_ - span.offset_bytes) + " of " +
                                 std::to_string(capacity_bytes_) + " are free",
                             map());
  }
  buffers_.push_back({name, span});
  return span;
}

std::string PolyMemory::map() const {
  std::string text = "  offset   bytes  buffer\n";
  char line[128];
  for (const Buffer& buffer : buffers_) {
    std::snprintf(line, sizeof(line), "%8d%8d  %s\n", buffer.span.offset_bytes, buffer.span.size_bytes,
                  buffer.name.c_str());
    text += line;
  }
  std::snprintf(line, sizeof(line), "%8d%8d  (free)\n", used_bytes(), capacity_bytes_ - used_bytes());
  text += line;
  std::snprintf(line, sizeof(line), "%8d%8d  (PE number, reserved by the ABI)\n", capacity_bytes_, kReservedBytes);
  return text + line;
}

}  // namespace cn
