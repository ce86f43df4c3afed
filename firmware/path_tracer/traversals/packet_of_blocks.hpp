#pragma once

#include <vector>

#include "firmware/path_tracer/kernels/ray_stream_kernels.hpp"
#include "firmware/path_tracer/traversals/packet_rays.hpp"
#include "firmware/path_tracer/traversals/tree_search.hpp"

/// Traversals that go through the tree once for several blocks of rays. A packet's blocks are loaded one by
/// one; the last goes through the tree with the others; then the hits are saved block by block.
namespace path_tracer {

/// The rays of a packet, one of each block in each PE, side by side in SRAM.
class PacketOfBlocks {
 public:
  PacketOfBlocks(cn::PolyMemory& memory, int blocks);

  int most_blocks() const { return static_cast<int>(blocks_.size()); }
  int offset_bytes() const { return blocks_.front().record.span().offset_bytes; }
  PacketBlock& operator[](int block) { return blocks_[std::size_t(block)]; }
  /// Of the ray queue's blocks, which the packet takes in turn.
  PacketBlock& of_queue(int block) { return (*this)[block % most_blocks()]; }

 private:
  std::vector<PacketBlock> blocks_;
};

/// Loads a block of the ray queue into the packet. The packet's last block takes all through the tree.
class PacketWalkStage : public PacketBase {
 public:
  PacketWalkStage(const StageContext& context, TreeContext& tree, PacketOfBlocks& rays)
      : PacketBase(context, tree), rays_(rays) {}

  const char* name() const override { return "packet stage"; }
  void load(std::uint64_t step, int block) override { load_packed_rays(step, block); }
  void process(std::uint64_t step, int block) override;
  void save(std::uint64_t /*step*/, int /*block*/) override {}

 protected:
  /// A block has been loaded, the first of which has number 0.
  virtual void add_block(int number) = 0;
  virtual void walk(int blocks) = 0;

  PacketOfBlocks& rays_;
};

/// Saves the hits of a block.
class PacketHitsStage : public TreeStage {
 public:
  PacketHitsStage(const StageContext& context, TreeContext& tree, PacketOfBlocks& rays)
      : TreeStage(context, tree), rays_(rays) {}

  const char* name() const override { return "packet stage"; }  // whose last part it is
  void load(std::uint64_t /*step*/, int /*block*/) override {}
  void process(std::uint64_t step, int block) override {
    finish(step, rays_.of_queue(block).record, rays_.of_queue(block).rays);
  }
  void save(std::uint64_t step, int /*block*/) override { save_hits(step); }

 private:
  PacketOfBlocks& rays_;
};

/// @tparam WalkStage a PacketWalkStage
template <class WalkStage>
class PacketOfBlocksTraversal : public TreeTraversal {
 public:
  PacketOfBlocksTraversal(const StageContext& context, TreeContext& tree)
      : queue_(tree.queue),
        num_pes_(context.machine.num_pes()),
        rays_(context.machine.poly_memory(), context.config.packet_blocks),
        walk_(context, tree, rays_),
        hits_(context, tree, rays_) {}

  void plan_first(const Plan& plan) override {
    const int blocks = (queue_.rays() + num_pes_ - 1) / num_pes_;
    for (int first = 0; first < blocks; first += rays_.most_blocks()) {
      const int end = std::min(blocks, first + rays_.most_blocks());
      for (int block = first; block < end; ++block) plan(walk_, block);
      for (int block = first; block < end; ++block) plan(hits_, block);
    }
  }
  void after_step(const Stage& /*stage*/, int /*block*/, const Plan& /*plan*/) override {}
  bool has(const Stage& stage) const override { return &stage == &walk_ || &stage == &hits_; }

 private:
  RayQueue& queue_;
  int num_pes_;
  PacketOfBlocks rays_;
  WalkStage walk_;
  PacketHitsStage hits_;
};

}  // namespace path_tracer
