#include "firmware/path_tracer/stages/scan_stage.hpp"

#include <algorithm>

#include "firmware/path_tracer/kernels/stream_kernels.hpp"

namespace path_tracer {

int ScanStage::begin_sweep(int sweep) {
  sweep_ = sweep;
  return (levels_.groups(level()) + num_pes() - 1) / num_pes();
}

LaneMask ScanStage::groups(int block) const {
  return LaneMask::first(std::min(num_pes(), int(levels_.groups(level())) - first_group(block)));
}

cn::MonoAddress ScanStage::word(int level, std::uint64_t number) const {
  return (context_.layout.path_numbers + levels_.first[std::size_t(level)] + number).address;
}

cn::MonoPlaces ScanStage::words(int block) const {
  return cn::MonoPlaces::array(word(level(), std::uint64_t(first_group(block)) * kScanRadix),
                               std::uint64_t{kWordsBytes});
}

cn::MonoPlaces ScanStage::sums(int block) const {
  return cn::MonoPlaces::array(word(level() + 1, std::uint64_t(first_group(block))), sizeof(std::uint64_t));
}

void ScanStage::load(std::uint64_t step, int block) {
  const cn::PolySpan buffer = context_.loads.buffer(step);
  context_.loads.copy_m2p(step, TransferRing::kNoBlock, {buffer.offset_bytes, kWordsBytes}, words(block),
                          groups(block));
  if (is_up() || starts_at_zero()) return;
  context_.loads.copy_m2p(step, TransferRing::kNoBlock,
                          {buffer.offset_bytes + kWordsBytes, sizeof(std::uint64_t)}, sums(block),
                          groups(block));
}

void ScanStage::process(std::uint64_t step, int block) {
  const StreamKernels& kernels = context_.kernels.stream();
  const int loaded = context_.loads.buffer(step).offset_bytes;
  const int saved = context_.saves.buffer(step).offset_bytes;
  ScanArguments arguments;
  arguments.words = {loaded};
  arguments.first_group = first_group(block);
  arguments.words_here = levels_.words[std::size_t(level())];
  arguments.sum = {is_up() ? saved : loaded + kWordsBytes};
  arguments.starts_at_zero = starts_at_zero();
  arguments.sums_before = {saved};
  context_.machine.run(is_up() ? kernels.scan_up : kernels.scan_down, arguments, groups(block));
}

void ScanStage::save(std::uint64_t step, int block) {
  const int bytes = is_up() ? int{sizeof(std::uint64_t)} : kWordsBytes;
  context_.saves.copy_p2m(step, TransferRing::kNoBlock, is_up() ? sums(block) : words(block),
                          {context_.saves.buffer(step).offset_bytes, bytes}, groups(block));
}

PathNumbers ScanStage::total() {
  return *context_.machine.read_mono(cn::MonoPointer<PathNumbers>{word(levels_.top(), 0)});
}

}  // namespace path_tracer
