#include "firmware/path_tracer/bidirectional/pair_context.hpp"

namespace path_tracer {
namespace {

PairWorld make_world(const StageContext& context) {
  PairWorld world;
  world.lens = make_lens(*context.machine.read_mono(context.layout.camera));
  world.centre = context.layout.centre;
  world.radius = context.layout.radius;
  world.light_vertices = context.config.light_vertices;
  world.has_lights = context.layout.light_count > 0;
  world.has_silent_lights = context.layout.has_silent_lights;
  return world;
}

}  // namespace

PairContext::PairContext(const StageContext& context, const PairKernels& pair_kernels)
    : kernels(pair_kernels),
      sizes(context.config.features, context.config.light_vertices),
      world(make_world(context)) {
  constexpr int kPlaces = 3 * int{sizeof(MonoAddress)};
  BufferCutter places(
      context.machine.poly_memory().allocate("places of vertices", kPlaces * context.config.bin_blocks));
  for (int i = 0; i < context.config.bin_blocks; ++i) {
    Block block;
    block.emission_place = places.take_place();
    block.near_place = places.take_place();
    block.far_place = places.take_place();
    blocks.push_back(block);
  }
}

}  // namespace path_tracer
