#include "firmware/path_tracer/stages/bins.hpp"

#include "firmware/path_tracer/stages/buffer_cutter.hpp"

namespace path_tracer {

Bins make_bins(cn::PolyMemory& memory, int blocks) {
  Bins bins;
  const int places_bytes = static_cast<int>(sizeof(MonoAddress)) * blocks;
  BufferCutter surface_places(memory.allocate("surface places", places_bytes));
  BufferCutter light_places(memory.allocate("light places", places_bytes));
  for (int i = 0; i < blocks; ++i) {
    Bins::Block block;
    block.surface_place = surface_places.take_place();
    block.light_place = light_places.take_place();
    bins.blocks.push_back(block);
  }
  return bins;
}

}  // namespace path_tracer
