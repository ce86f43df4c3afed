#pragma once

#include <cstdint>
#include <vector>

#include "model/waves/wave_config.hpp"
#include "model/waves/wave_recorder.hpp"

namespace model {

/// Opens and closes the recorder's windows that are told in blocks, as the blocks' kernels begin.
class BlockWindows {
 public:
  static constexpr std::size_t kBlocksRemembered = 8;

  BlockWindows(const std::vector<BlockWindow>& windows, WaveRecorder& recorder);

  /// Kernels of the next block begin at `start`.
  void begin_block(Cycles start);
  std::uint64_t blocks_begun() const { return blocks_begun_; }
  /// When kernels of the first recorded blocks began, kBlocksRemembered of them at most.
  const std::vector<Cycles>& block_starts() const { return block_starts_; }

 private:
  std::vector<BlockWindow> windows_;
  WaveRecorder& recorder_;
  std::uint64_t blocks_begun_ = 0;
  std::vector<Cycles> block_starts_;
};

}  // namespace model
