#include "firmware/path_tracer/stages/bins.hpp"

#include "firmware/path_tracer/stages/buffer_cutter.hpp"

namespace path_tracer {

Bins make_bins(cn::PolyMemory& memory, const ProgramConfig& config) {
  const int blocks = config.bin_blocks;
  Bins bins;
  bins.blocks.resize(std::size_t(blocks));
  if (config.is_stream()) return bins;
  const int places_bytes = static_cast<int>(sizeof(MonoAddress)) * blocks;
  BufferCutter surface_places(memory.allocate("surface places", places_bytes));
  BufferCutter light_places(memory.allocate("light places", places_bytes));
  for (Bins::Block& block : bins.blocks) {
    block.surface_place = surface_places.take_place();
    block.light_place = light_places.take_place();
  }
  return bins;
}

}  // namespace path_tracer
