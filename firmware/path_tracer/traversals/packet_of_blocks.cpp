#include "firmware/path_tracer/traversals/packet_of_blocks.hpp"

namespace path_tracer {

PacketOfBlocks::PacketOfBlocks(cn::PolyMemory& memory, int blocks) : blocks_(std::size_t(blocks)) {
  BufferCutter cutter(memory.allocate("packet", blocks * int{sizeof(StreamRay)}));
  for (PacketBlock& block : blocks_) {
    const auto ray = cutter.take<StreamRay>();
    block.record = ray.part(&StreamRay::record);
    block.packet = ray.part(&StreamRay::packet);
  }
}

void PacketWalkStage::process(std::uint64_t step, int block) {
  PacketBlock& loaded = rays_.of_queue(block);
  loaded.rays = packed_rays(block);
  enter(step, loaded.record, loaded.rays);
  count_pass(0, loaded.rays);
  begin(step, loaded, nullptr);
  const int number = block % rays_.most_blocks();
  add_block(number);
  const bool is_last_of_queue = (block + 1) * num_pes() >= tree_.queue.rays();
  if (number + 1 == rays_.most_blocks() || is_last_of_queue) walk(number + 1);
}

}  // namespace path_tracer
