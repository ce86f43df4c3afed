#include "firmware/path_tracer/stages.hpp"

namespace path_tracer {

LightStage::Loads LightStage::loads(std::uint64_t step) const {
  BufferCutter cutter(context_.loads.buffer(step));
  return {cutter.take<ShadingRecord>(), cutter.take<LightRecord>()};
}

LightStage::Saves LightStage::saves(std::uint64_t step) const {
  BufferCutter cutter(context_.saves.buffer(step));
  return {cutter.take<RayRecord>(), cutter.take<LightingRecord>()};
}

void LightStage::load(std::uint64_t step, int block) {
  context_.saves.wait_block(block);
  const Loads to = loads(step);
  const Bins::Block& bin = bin_block(block);
  load_block(step, block, to.shading, context_.layout.shading_bin, bin.wants_light);
  context_.loads.copy_m2p(step, block, to.light.span(), context_.machine.places_in(bin.light_place),
                          bin.wants_light);
}

/// Shadow rays that could not bring light end here.
void LightStage::process(std::uint64_t step, int block) {
  const Loads from = loads(step);
  const Saves to = saves(step);
  LaneMask can_see;
  AimArguments arguments;
  arguments.shading = from.shading;
  arguments.light = from.light;
  arguments.ray = to.ray;
  arguments.lighting = to.lighting;
  arguments.can_see = &can_see;
  LaneMask& wants_light = bin_block(block).wants_light;
  context_.machine.run(context_.kernels.aim, arguments, wants_light);
  wants_light = can_see;
}

void LightStage::save(std::uint64_t step, int block) {
  const Saves from = saves(step);
  const LaneMask& wants_light = bin_block(block).wants_light;
  save_block(step, block, context_.layout.ray_bin, from.ray, wants_light);
  save_block(step, block, context_.layout.lighting_bin, from.lighting, wants_light);
}

}  // namespace path_tracer
