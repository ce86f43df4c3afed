#include "firmware/path_tracer/pipeline/scratchpad_records.hpp"

#include <algorithm>
#include <string>

namespace path_tracer {
namespace {

/// Arrays start on a multiple of a packet of the network, as records expect.
constexpr std::uint64_t kPacketBytes = 64;

/// Instructions of the control unit for a transfer (assumed): addresses, the call, the loop.
constexpr std::uint64_t kCopyInstructions = 12;

}  // namespace

ScratchpadRecords::ScratchpadRecords(cn::Machine& machine, TransferRing& buffers, Scratchpad wanted,
                                     Layout& layout)
    : machine_(machine),
      buffers_(buffers),
      layout_(layout),
      memory_(machine.scratchpad()),
      next_(memory_.first) {
  const bool all = wanted == Scratchpad::fitting;
  if (all || wanted == Scratchpad::nodes) take("nodes", !all, layout.nodes);
  if (all || wanted == Scratchpad::triangles) take("triangles", !all, layout.triangles);
  if (all) take("surfaces", false, layout.surfaces);
  if (all) take("lights", false, layout.lights);
}

template <class T>
void ScratchpadRecords::take(const char* region, bool must_fit, cn::MonoPointer<T>& array) {
  const auto has_name = [&](const Layout::Region& of) { return of.name == std::string(region); };
  const auto found = std::find_if(layout_.regions.begin(), layout_.regions.end(), has_name);
  if (found == layout_.regions.end() || found->bytes == 0) return;
  const std::uint64_t free_bytes = memory_.first + memory_.bytes - next_;
  if (found->bytes > free_bytes) {
    if (!must_fit) return;
    throw ProgramError("scratchpad: found " + std::string(region) + " of " + std::to_string(found->bytes) +
                       " bytes, the memory on the chip (on_chip_sram.size_bytes) has " +
                       std::to_string(free_bytes));
  }
  copy(found->first, next_, found->bytes);
  array.address = next_;
  next_ += (found->bytes + kPacketBytes - 1) / kPacketBytes * kPacketBytes;
  next_ = std::min(next_, memory_.first + memory_.bytes);
}

/// Pieces side by side, one for each PE and request; the last request is a single, shorter one.
void ScratchpadRecords::copy(cn::MonoAddress from, cn::MonoAddress to, std::uint64_t bytes) {
  const auto piece_bytes = std::uint64_t(buffers_.buffer(0).size_bytes / 8 * 8);
  while (bytes >= piece_bytes) {
    const std::uint64_t pes = std::min(bytes / piece_bytes, std::uint64_t(machine_.num_pes()));
    copy_pieces(from, to, int(piece_bytes), int(pes));
    from += pes * piece_bytes;
    to += pes * piece_bytes;
    bytes -= pes * piece_bytes;
  }
  if (bytes > 0) copy_pieces(from, to, int(bytes), 1);
}

void ScratchpadRecords::copy_pieces(cn::MonoAddress from, cn::MonoAddress to, int piece_bytes, int pes) {
  const cn::PolySpan span{buffers_.buffer(0).offset_bytes, piece_bytes};
  const cn::LaneMask enabled = cn::LaneMask::first(pes);
  machine_.issue_mono(kCopyInstructions);
  buffers_.copy_m2p(0, TransferRing::kNoBlock, span, cn::MonoPlaces::array(from, std::uint64_t(piece_bytes)),
                    enabled);
  buffers_.wait(0);
  buffers_.copy_p2m(0, TransferRing::kNoBlock, cn::MonoPlaces::array(to, std::uint64_t(piece_bytes)), span,
                    enabled);
  buffers_.wait(0);
}

}  // namespace path_tracer
