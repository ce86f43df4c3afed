#include "firmware/path_tracer/bidirectional/connection_stage.hpp"

namespace path_tracer {

int ConnectionStage::load_bytes(const ProgramConfig& config) {
  const PairSizes sizes(config.features, config.light_vertices);
  return sizes.pair + 2 * sizes.vertex + int{sizeof(LightRecord)} + int{sizeof(LightEmissionRecord)};
}

int ConnectionStage::save_bytes(const ProgramConfig& config) {
  return PairSizes(config.features, config.light_vertices).pair + RayStore::room_bytes(config);
}

ConnectionStage::Loads ConnectionStage::loads(std::uint64_t step) const {
  BufferCutter cutter(context_.loads.buffer(step));
  return {cutter.take_bytes<PairRecord>(pairs_.sizes.pair),
          cutter.take_bytes<PathVertexRecord>(pairs_.sizes.vertex),
          cutter.take_bytes<PathVertexRecord>(pairs_.sizes.vertex), cutter.take<LightRecord>(),
          cutter.take<LightEmissionRecord>()};
}

ConnectionStage::Saves ConnectionStage::saves(std::uint64_t step) const {
  BufferCutter cutter(context_.saves.buffer(step));
  return {cutter.take_bytes<PairRecord>(pairs_.sizes.pair), rays_.take_room(cutter)};
}

void ConnectionStage::load(std::uint64_t step, int block) {
  context_.saves.wait_block(block);
  const Loads to = loads(step);
  const PairContext::Block& pairs = pairs_.block(block);
  const auto load_pairs = [&](int bytes, const LaneMask& lanes) {
    context_.loads.copy_m2p(step, block, with_tail(to.pair, bytes),
                            block_of(context_.layout.pair_bin, block, pairs_.sizes.pair), lanes);
  };
  load_pairs(pairs_.sizes.pair, pairs.needs_segment);
  load_pairs(pairs_.sizes.pair_of_connection, pairs.occupied.without(pairs.needs_segment));
  const auto gather = [&](cn::PolySpan span, PolyField<MonoAddress> place, const LaneMask& needed) {
    context_.loads.copy_m2p(step, block, span, context_.machine.places_in(place), needed);
  };
  gather(with_tail(to.near_vertex, pairs_.sizes.vertex), pairs.near_place, pairs.needs_near);
  gather(with_tail(to.far_vertex, pairs_.sizes.vertex), pairs.far_place, pairs.needs_far);
  if (!pairs_.world.has_lights) return;
  gather(to.light.span(), bin_block(block).light_place, pairs.needs_light);
  gather(to.emission.span(), pairs.emission_place, pairs.needs_emission);
}

void ConnectionStage::process(std::uint64_t step, int block) {
  const Loads from = loads(step);
  const Saves to = saves(step);
  Bins::Block& bin = bin_block(block);
  PairContext::Block& pairs = pairs_.block(block);
  context_.machine.run(pairs_.kernels.copy_pair,
                       {from.pair.span().offset_bytes, to.pair.span().offset_bytes, pairs_.sizes.pair},
                       pairs.occupied);
  LaneMask connects;
  LaneMask culled;
  pairs.of_light = pairs.to_lens = pairs.to_vertex = LaneMask{};
  ConnectArguments arguments;
  arguments.world = pairs_.world;
  arguments.pair_sizes = pairs_.sizes;
  arguments.features = context_.config.features;
  arguments.skips_absent_lobes = context_.config.shading != Shading::every_lobe;
  arguments.camera = context_.machine.read_mono(context_.layout.camera);
  arguments.image = context_.layout.environment_image;
  arguments.sampler = context_.config.sampler;
  arguments.light_sampling = context_.config.light_sampling;
  arguments.seed = context_.config.seed;
  arguments.is_in_layers = context_.layout.layers.any;
  arguments.lights = context_.layout.lights.address;
  arguments.light_place = bin.light_place;
  arguments.pair = to.pair;
  arguments.light = from.light;
  arguments.emission = from.emission;
  arguments.near_vertex = from.near_vertex;
  arguments.far_vertex = from.far_vertex;
  arguments.ray = to.ray.ray;
  arguments.connects = &connects;
  arguments.to_lens = &pairs.to_lens;
  arguments.to_vertex = &pairs.to_vertex;
  arguments.of_light = &pairs.of_light;
  arguments.is_culled = &culled;
  context_.machine.run(pairs_.kernels.connect, arguments, pairs.occupied);
  bin.live = pairs.occupied;
  bin.shadow = connects;
  bin.count_rays();
  count(pairs, connects, culled);
}

/// Statistics of the simulator; the chip does not count, so this is free.
void ConnectionStage::count(const PairContext::Block& pairs, const LaneMask& connects,
                            const LaneMask& culled) {
  const auto of = [](const LaneMask& lanes) { return std::uint64_t(lanes.count()); };
  ConnectionCounts& counts = context_.counts.connections;
  counts.light_segments += of(pairs.of_light);
  counts.to_lens += of(pairs.to_lens);
  counts.to_light_vertices += of(pairs.to_vertex);
  counts.to_lights += of(connects) - of(pairs.to_lens) - of(pairs.to_vertex);
  context_.counts.culled_shadow_rays += of(culled);
}

void ConnectionStage::save(std::uint64_t step, int block) {
  const Saves from = saves(step);
  const PairContext::Block& pairs = pairs_.block(block);
  const auto save_pairs = [&](int bytes, const LaneMask& lanes) {
    context_.saves.copy_p2m(step, block, block_of(context_.layout.pair_bin, block, pairs_.sizes.pair),
                            with_tail(from.pair, bytes), lanes);
  };
  save_pairs(pairs_.sizes.pair, pairs.starts);
  save_pairs(pairs_.sizes.pair_of_connection, pairs.occupied.without(pairs.starts));
  rays_.save(context_.saves, step, {block}, from.ray, bin_block(block).light_place, pairs.occupied);
}

}  // namespace path_tracer
