#include "model/hazards/poly_occupancy.hpp"

namespace model {
namespace {

constexpr int kWordBytes = 8;

int first_word(cn::PolySpan span) {
  return span.offset_bytes / kWordBytes;
}
int end_word(cn::PolySpan span) {
  return (span.offset_bytes + span.size_bytes + kWordBytes - 1) / kWordBytes;
}

}  // namespace

PolyOccupancy::PolyOccupancy(const cn::PolyMemory& memory)
    : strips_(memory.num_pes() / cn::kStripLanes),
      written_(std::size_t(strips_) *
               std::size_t((memory.capacity_bytes() + cn::PolyMemory::kReservedBytes) / kWordBytes)),
      read_(written_.size()) {}

template <class Change>
void PolyOccupancy::change(Bits& all, cn::PolySpan span, const cn::LaneMask& pes, Change&& change_bits) {
  for (int word = first_word(span); word < end_word(span); ++word)
    for (int strip = 0; strip < strips_; ++strip)
      change_bits(all[std::size_t(word * strips_ + strip)], pes.strip_bits(strip));
}

void PolyOccupancy::add(cn::Access access, cn::PolySpan span, const cn::LaneMask& pes) {
  change(bits(access), span, pes,
         [](std::uint8_t& at, std::uint8_t set) { at = static_cast<std::uint8_t>(at | set); });
}

void PolyOccupancy::remove(cn::Access access, cn::PolySpan span, const cn::LaneMask& pes) {
  change(bits(access), span, pes,
         [](std::uint8_t& at, std::uint8_t cleared) { at = static_cast<std::uint8_t>(at & ~cleared); });
}

PolyOccupancy::Conflict PolyOccupancy::find(cn::Access access, cn::PolySpan bytes, int first_pe,
                                            std::uint32_t pes) const {
  const int strip = first_pe / cn::kStripLanes;
  for (int word = first_word(bytes); word < end_word(bytes); ++word) {
    const auto at = std::size_t(word * strips_ + strip);
    std::uint32_t taken = written_[at];
    if (access == cn::Access::write) taken |= read_[at];
    if ((taken & pes) != 0) return {word * kWordBytes, first_pe + __builtin_ctz(taken & pes)};
  }
  return {};
}

PolyOccupancy::Conflict PolyOccupancy::find(cn::Access access, cn::PolySpan bytes,
                                            const cn::LaneMask& pes) const {
  for (int strip = 0; strip < strips_; ++strip) {
    const Conflict conflict = find(access, bytes, strip * cn::kStripLanes, pes.strip_bits(strip));
    if (conflict.pe >= 0) return conflict;
  }
  return {};
}

}  // namespace model
