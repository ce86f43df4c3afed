#include "firmware/path_tracer/stages.hpp"

namespace path_tracer {

LightingStage::Loads LightingStage::loads(std::uint64_t step) const {
  BufferCutter cutter(context_.loads.buffer(step));
  return {cutter.take<SurfaceRecord>(), cutter.take<LightingRecord>()};
}

void LightingStage::load(std::uint64_t step, int block) {
  context_.saves.wait_block(block);
  const Loads to = loads(step);
  const Bins::Block& bin = bin_block(block);
  context_.loads.copy_m2p(step, block, to.surface.span(), context_.machine.places_in(bin.surface_place),
                          bin.hit_something);
  load_block(step, block, to.lighting, context_.layout.lighting_bin, bin.hit_something);
}

/// A shadow ray that hit nothing brings nothing.
void LightingStage::process(std::uint64_t step, int block) {
  const Loads from = loads(step);
  Bins::Block& bin = bin_block(block);
  bin.wants_light = bin.hit_something;
  IlluminateArguments arguments;
  arguments.surface = from.surface;
  arguments.lighting = from.lighting;
  arguments.direct_light = PolyPointer<DirectLightRecord>(context_.saves.buffer(step));
  context_.machine.run(context_.kernels.illuminate, arguments, bin.wants_light);
}

void LightingStage::save(std::uint64_t step, int block) {
  const PolyPointer<DirectLightRecord> direct_light(context_.saves.buffer(step));
  save_block(step, block, context_.layout.direct_light_bin, direct_light, bin_block(block).wants_light);
}

}  // namespace path_tracer
