#include "firmware/path_tracer/stages.hpp"

namespace path_tracer {

IntersectionStage::Loads IntersectionStage::loads(std::uint64_t step) const {
  BufferCutter cutter(context_.loads.buffer(step));
  return {cutter.take<HitRecord>(), cutter.take<SurfaceRecord>(), cutter.take<PathRecord>()};
}

IntersectionStage::Saves IntersectionStage::saves(std::uint64_t step) const {
  BufferCutter cutter(context_.saves.buffer(step));
  const auto scatter = cutter.take<ScatterRecord>();
  if (context_.config.program == Program::segments) return {scatter, {}};
  return {scatter, cutter.take<ShadowRecord>()};
}

void IntersectionStage::load(std::uint64_t step, int block) {
  context_.saves.wait_block(block);
  const Loads to = loads(step);
  const Bins::Block& bin = bin_block(block);
  load_block(step, block, to.hit, context_.layout.intersection_bin, bin.live);
  context_.loads.copy_m2p(step, block, to.surface.span(), context_.machine.places_in(bin.surface_place),
                          bin.hit_something);
  load_block(step, block, to.path, context_.layout.path_bin, bin.live);
}

void IntersectionStage::process(std::uint64_t step, int block) {
  Bins::Block& bin = bin_block(block);
  const Loads from = loads(step);
  const Saves to = saves(step);
  bin.wants_light = LaneMask{};
  ScatterArguments arguments;
  arguments.hit = from.hit;
  arguments.surface = from.surface;
  arguments.path = from.path;
  arguments.sampler = context_.config.sampler;
  arguments.seed = context_.config.seed;
  arguments.roulette_start = context_.config.roulette_start;
  arguments.max_survival = context_.config.max_survival;
  arguments.light_by_shadow_rays = context_.config.program != Program::segments;
  if (arguments.light_by_shadow_rays) {
    arguments.light_count = context_.layout.light_count;
    arguments.light_cdf =
        context_.machine.read_mono(context_.layout.light_cdf, std::size_t(arguments.light_count));
    arguments.lights = context_.layout.lights.address;
    arguments.light_place = bin.light_place;
  }
  arguments.scatter = to.scatter;
  arguments.shadow = to.shadow;
  arguments.wants_light = &bin.wants_light;
  context_.machine.run(context_.kernels.scatter, arguments, bin.live);
}

void IntersectionStage::save(std::uint64_t step, int block) {
  const Saves from = saves(step);
  const Bins::Block& bin = bin_block(block);
  save_block(step, block, context_.layout.scatter_bin, from.scatter, bin.live);
  if (context_.config.program != Program::segments)
    save_block(step, block, context_.layout.shadow_bin, from.shadow, bin.wants_light);
}

}  // namespace path_tracer
