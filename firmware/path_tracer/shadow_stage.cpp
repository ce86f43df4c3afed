#include "firmware/path_tracer/stages.hpp"

namespace path_tracer {

ShadowStage::Loads ShadowStage::loads(std::uint64_t step) const {
  BufferCutter cutter(context_.loads.buffer(step));
  return {cutter.take<ShadowRecord>(), cutter.take<LightRecord>()};
}

void ShadowStage::load(std::uint64_t step, int block) {
  context_.saves.wait_block(block);
  const Loads to = loads(step);
  const Bins::Block& bin = bin_block(block);
  load_block(step, block, to.shadow, context_.layout.shadow_bin, bin.wants_light);
  context_.loads.copy_m2p(step, block, to.light.span(), context_.machine.places_in(bin.light_place),
                          bin.wants_light);
}

void ShadowStage::process(std::uint64_t step, int block) {
  const Loads from = loads(step);
  ShadowArguments arguments;
  arguments.shadow = from.shadow;
  arguments.light = from.light;
  arguments.light_sampling = context_.config.light_sampling;
  arguments.triangle_count = context_.layout.triangle_count;
  arguments.triangles =
      context_.machine.read_mono(context_.layout.triangles, std::size_t(arguments.triangle_count));
  arguments.direct_light = PolyPointer<DirectLightRecord>(context_.saves.buffer(step));
  const LaneMask& wants_light = bin_block(block).wants_light;
  context_.machine.run(context_.kernels.shadow, arguments, wants_light);
  context_.counts.shadow_rays += std::uint64_t(wants_light.count());
}

void ShadowStage::save(std::uint64_t step, int block) {
  const PolyPointer<DirectLightRecord> direct_light(context_.saves.buffer(step));
  save_block(step, block, context_.layout.direct_light_bin, direct_light, bin_block(block).wants_light);
}

}  // namespace path_tracer
