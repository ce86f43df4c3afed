#include "firmware/path_tracer/bidirectional/vertex_stage.hpp"

#include <algorithm>

namespace path_tracer {
namespace {

template <class Work>
void for_each_lane(const LaneMask& lanes, int num_pes, const Work& work) {
  for (int strip = 0; strip < num_pes / cn::kStripLanes; ++strip)
    for (std::uint32_t bits = lanes.strip_bits(strip); bits != 0; bits &= bits - 1)
      work(strip * cn::kStripLanes + __builtin_ctz(bits));
}

}  // namespace

VertexStage::VertexStage(const StageContext& context, PairContext& pairs, const Work& work)
    : Stage(context),
      pairs_(pairs),
      camera_rays_(work, pairs.world.lens.width * pairs.world.lens.height),
      is_listed_(work.listed_samples > 0),
      number_{context.machine.poly_memory().allocate("ascending numbers", sizeof(std::int32_t)).offset_bytes},
      segments_(std::size_t(context.config.bin_blocks) * std::size_t(context.machine.num_pes())) {
  require_pixel_stride(context.config.pixel_stride, camera_rays_.pixels());
}

int VertexStage::load_bytes(const ProgramConfig& config) {
  const RecordSizes sizes(config.features);
  const PairSizes of_pairs(config.features, config.light_vertices);
  return sizes.hit + sizes.surface + sizes.look_ups + of_pairs.pair + of_pairs.heads;
}

int VertexStage::save_bytes(const ProgramConfig& config) {
  const PairSizes sizes(config.features, config.light_vertices);
  return sizes.pair + sizes.vertex + int{sizeof(LightHeadRecord)} + int{sizeof(RadianceRecord)} +
         3 * int{sizeof(MonoAddress)};
}

VertexStage::Loads VertexStage::loads(std::uint64_t step) const {
  BufferCutter cutter(context_.loads.buffer(step));
  const RecordSizes& sizes = context_.layout.sizes;
  return {cutter.take_bytes<HitRecord>(sizes.hit), cutter.take_bytes<SurfaceRecord>(sizes.surface),
          cutter.take_bytes<TextureLookUp>(sizes.look_ups), cutter.take_bytes<PairRecord>(pairs_.sizes.pair),
          cutter.take_bytes<LightHeadRecord>(pairs_.sizes.heads)};
}

VertexStage::Saves VertexStage::saves(std::uint64_t step) const {
  BufferCutter cutter(context_.saves.buffer(step));
  return {cutter.take_bytes<PairRecord>(pairs_.sizes.pair),
          cutter.take_bytes<PathVertexRecord>(pairs_.sizes.vertex),
          cutter.take<LightHeadRecord>(),
          cutter.take<RadianceRecord>(),
          cutter.take_place(),
          cutter.take_place(),
          cutter.take_place()};
}

MonoAddress VertexStage::block_vertices(int block) const {
  const std::uint64_t of_slot =
      std::uint64_t(pairs_.world.light_vertices + 1) * std::uint64_t(pairs_.sizes.vertex);
  return context_.layout.path_vertices.address + first_slot(block) * of_slot;
}

MonoAddress VertexStage::block_heads(int block) const {
  return context_.layout.light_heads.address + first_slot(block) * std::uint64_t(pairs_.sizes.heads);
}

/// Slots whose eye path has a new vertex.
LaneMask VertexStage::eye_hits(int block) const {
  const Bins::Block& bin = bin_block(block);
  return bin.hit_something.without(bin.shadow).without(pairs_.block(block).of_light);
}

void VertexStage::load(std::uint64_t step, int block) {
  context_.saves.wait_block(block);
  const Loads to = loads(step);
  const Bins::Block& bin = bin_block(block);
  const RecordSizes& sizes = context_.layout.sizes;
  load_block(step, block, to.hit, context_.layout.intersection_bin, bin.live, sizes.hit);
  load_hit_surfaces(step, block);
  const auto load_pairs = [&](int bytes, const LaneMask& lanes) {
    context_.loads.copy_m2p(step, block, with_tail(to.pair, bytes),
                            block_of(context_.layout.pair_bin, block, pairs_.sizes.pair), lanes);
  };
  load_pairs(pairs_.sizes.pair, bin.segments());
  load_pairs(pairs_.sizes.pair_of_connection, bin.shadow);
  load_block(step, block, to.heads, context_.layout.light_heads, eye_hits(block), pairs_.sizes.heads);
}

/// A connection needs of what it hit only the face, and a light's emission; one to the lens needs nothing. In
/// scenes with coverage each needs it.
void VertexStage::load_hit_surfaces(std::uint64_t step, int block) {
  const Loads to = loads(step);
  const Bins::Block& bin = bin_block(block);
  const PairContext::Block& pairs = pairs_.block(block);
  Bins::Block whole = bin;
  // What may let a ray through is asked for its coverage, whatever the ray is.
  if (!context_.config.features.coverage)
    whole.hit_something = bin.hit_something.without(pairs.to_lens).without(pairs.to_vertex);
  load_surfaces(context_, step, block, whole, {to.hit, to.surface, to.look_ups});
  if (context_.config.features.coverage) return;
  constexpr int kFace = int{offsetof(SurfaceRecord, face)};
  context_.loads.copy_m2p(step, block,
                          {to.surface.span().offset_bytes + kFace, int{sizeof(SurfaceRecord)} - kFace},
                          context_.machine.places_in(bin.surface_place, kFace),
                          bin.hit_something.without(whole.hit_something).without(pairs.to_lens));
}

void VertexStage::prepare(std::uint64_t step, int block) {
  context_.loads.wait(step);
  const Loads from = loads(step);
  load_texels(context_, step, block, bin_block(block), {from.hit, from.surface, from.look_ups});
  if (context_.config.features.lights.environment) look_up_sky(step, block);
}

void VertexStage::look_up_sky(std::uint64_t step, int block) {
  const Loads from = loads(step);
  LaneMask needs;
  SkyLookUpArguments arguments;
  arguments.hit = from.hit;
  arguments.pair = from.pair;
  arguments.image = context_.layout.environment_image;
  arguments.look_up =
      PolyPointer<EnvironmentLookUp>(from.look_ups.span().offset_bytes + context_.layout.sizes.environment);
  arguments.needs = &needs;
  context_.machine.run(pairs_.kernels.look_up_sky, arguments, bin_block(block).live);
  context_.loads.copy_m2p(step, block, arguments.look_up.part(&EnvironmentLookUp::texel).span(),
                          context_.machine.places_in(arguments.look_up.field(&EnvironmentLookUp::place)),
                          needs);
}

void VertexStage::process(std::uint64_t step, int block) {
  const Bins::Block& bin = bin_block(block);
  context_.machine.run(
      pairs_.kernels.copy_pair,
      {loads(step).pair.span().offset_bytes, saves(step).pair.span().offset_bytes, pairs_.sizes.pair},
      bin.live);
  count_segments(block);
  see(step, block);
  reach(step, block);
  decide(step, block);
  count_ended(block);
  list_results(step);
  begin_pairs(step, block);
  locate_far(step, block);
}

void VertexStage::reach(std::uint64_t step, int block) {
  const Loads from = loads(step);
  const Saves to = saves(step);
  vertices_ = LaneMask{};
  light_vertices_ = LaneMask{};
  const LaneMask segments = bin_block(block).segments();
  if (!segments.any()) return;
  LobeUse lobe_use;
  ReachArguments arguments;
  arguments.hit = from.hit;
  arguments.surface = from.surface;
  arguments.look_ups = from.look_ups;
  arguments.sampler = context_.config.sampler;
  arguments.seed = context_.config.seed;
  arguments.roulette_start = context_.config.roulette_start;
  arguments.max_survival = context_.config.max_survival;
  arguments.features = context_.config.features;
  arguments.sizes = context_.layout.sizes;
  arguments.skips_absent_lobes = context_.config.shading != Shading::every_lobe;
  arguments.environment = context_.layout.environment;
  arguments.image = context_.layout.environment_image;
  arguments.sun_count = context_.layout.sun_count;
  if (arguments.sun_count > 0) {
    const auto count = std::size_t(arguments.sun_count);
    arguments.suns = context_.machine.read_mono(context_.layout.suns, count);
    arguments.sun_pdfs = context_.machine.read_mono(context_.layout.sun_pdfs, count);
  }
  arguments.lobe_use = &lobe_use;
  arguments.world = pairs_.world;
  arguments.pair_sizes = pairs_.sizes;
  arguments.pair = to.pair;
  arguments.heads = from.heads;
  arguments.vertex = to.vertex;
  arguments.head = to.head;
  arguments.block_vertices = block_vertices(block);
  arguments.block_heads = block_heads(block);
  arguments.vertex_place = to.vertex_place;
  arguments.head_place = to.head_place;
  arguments.is_vertex = &vertices_;
  arguments.is_light_vertex = &light_vertices_;
  context_.machine.run(pairs_.kernels.reach, arguments, segments);
  count_lobes(lobe_use, arguments.features.lobes, arguments.skips_absent_lobes, num_pes(),
              context_.counts.lobes);
}

void VertexStage::see(std::uint64_t step, int block) {
  const Loads from = loads(step);
  const Saves to = saves(step);
  reached_lens_ = LaneMask{};
  SeeArguments arguments;
  arguments.hit = from.hit;
  arguments.surface = from.surface;
  arguments.look_ups = from.look_ups;
  arguments.features = context_.config.features;
  arguments.sizes = context_.layout.sizes;
  arguments.is_in_layers = context_.layout.layers.any;
  arguments.sampler = context_.config.sampler;
  arguments.seed = context_.config.seed;
  arguments.pair_sizes = pairs_.sizes;
  arguments.pair = to.pair;
  arguments.result = to.result;
  arguments.is_result = &reached_lens_;
  context_.machine.run(pairs_.kernels.see, arguments, bin_block(block).shadow);
}

void VertexStage::decide(std::uint64_t step, int block) {
  const Saves to = saves(step);
  ended_ = LaneMask{};
  DecideArguments arguments;
  arguments.pair_sizes = pairs_.sizes;
  arguments.pair = to.pair;
  arguments.light_vertices = pairs_.world.light_vertices;
  arguments.result = to.result;
  arguments.ended = &ended_;
  context_.machine.run(pairs_.kernels.decide, arguments, bin_block(block).live);
}

void VertexStage::list_results(std::uint64_t step) {
  result_lanes_ = ended_.with(reached_lens_);
  const int count = context_.machine.number_ascending(result_lanes_, number_);
  if (count == 0) return;
  NumberedPlaceArguments arguments;
  arguments.number = number_;
  arguments.records = {(half_ + std::uint64_t(results_)).address, int{sizeof(RadianceRecord)}};
  arguments.place = saves(step).result_place;
  context_.machine.run(context_.kernels.finished_place, arguments, result_lanes_);
  results_ += count;
  last_result_step_ = step;
}

/// Gathers the list's entries for the pairs that begin, straight to where their records are made. The step
/// waits for them: which slots begin a pair is known no earlier. Their places lie where results' places were
/// to be.
void VertexStage::load_listed(std::uint64_t step, int block, std::int32_t begun) {
  const Loads from = loads(step);
  LaneMask starts;
  ListedSampleArguments arguments;
  arguments.number = number_;
  arguments.started = begun;
  arguments.next_listed = (context_.layout.camera_samples + camera_rays_.issued()).address;
  arguments.place = PolyField<MonoAddress>{from.hit.span().offset_bytes};
  arguments.starts = &starts;
  context_.machine.run(context_.kernels.listed_sample, arguments, ended_);
  context_.loads.copy_m2p(step, block, with_tail(saves(step).pair, int{sizeof(CameraSampleRecord)}),
                          context_.machine.places_in(arguments.place), starts);
  context_.loads.wait(step);
}

void VertexStage::begin_pairs(std::uint64_t step, int block) {
  const Saves to = saves(step);
  PairContext::Block& pairs = pairs_.block(block);
  const int count = context_.machine.number_ascending(ended_, number_);
  const auto begun =
      static_cast<std::int32_t>(std::min<std::uint64_t>(camera_rays_.remaining(), std::uint64_t(count)));
  if (is_listed_ && begun > 0) load_listed(step, block, begun);
  LaneMask begins;
  BeginPairArguments arguments;
  arguments.number = number_;
  arguments.remaining = begun;
  arguments.camera = context_.machine.read_mono(context_.layout.camera);
  arguments.order = {camera_rays_.next_pixel(), camera_rays_.next_sample(),
                     context_.config.pixel_stride % camera_rays_.pixels()};
  arguments.is_listed = is_listed_;
  arguments.has_lights = pairs_.world.has_lights;
  arguments.pair = to.pair;
  arguments.begins = &begins;
  context_.machine.run(pairs_.kernels.begin_pair, arguments, ended_);
  camera_rays_.issue(std::uint64_t(begun));
  pairs.occupied = bin_block(block).live.without(ended_).with(begins);
  reached_ = bin_block(block).segments().without(ended_);
}

void VertexStage::locate_far(std::uint64_t step, int block) {
  PairContext::Block& pairs = pairs_.block(block);
  pairs.needs_light = pairs.needs_emission = pairs.needs_near = pairs.needs_far = LaneMask{};
  LaneMask segments;
  pairs.starts = LaneMask{};
  LocateFarArguments arguments;
  arguments.pair_sizes = pairs_.sizes;
  arguments.has_silent_lights = pairs_.world.has_silent_lights;
  arguments.pair = saves(step).pair;
  if (pairs_.world.has_lights) arguments.light_table = read_light_table(context_.machine, context_.layout);
  arguments.lights = context_.layout.lights.address;
  arguments.light_emission = context_.layout.light_emission.address;
  arguments.block_vertices = block_vertices(block);
  arguments.vertex_bytes = pairs_.sizes.vertex;
  arguments.light_vertices = pairs_.world.light_vertices;
  arguments.sampler = context_.config.sampler;
  arguments.seed = context_.config.seed;
  arguments.light_place = bin_block(block).light_place;
  arguments.emission_place = pairs.emission_place;
  arguments.near_place = pairs.near_place;
  arguments.far_place = pairs.far_place;
  arguments.needs_light = &pairs.needs_light;
  arguments.needs_emission = &pairs.needs_emission;
  arguments.needs_near = &pairs.needs_near;
  arguments.needs_far = &pairs.needs_far;
  arguments.needs_segment = &segments;
  arguments.starts = &pairs.starts;
  context_.machine.run(pairs_.kernels.locate_far, arguments, pairs.occupied);
  pairs.needs_segment = segments.with(pairs.needs_far);
}

void VertexStage::fill(std::uint64_t step, int block) {
  vertices_ = light_vertices_ = result_lanes_ = LaneMask{};
  bin_block(block).live = bin_block(block).shadow = LaneMask{};
  ended_ = LaneMask::first(num_pes());
  begin_pairs(step, block);
  locate_far(step, block);
}

/// Statistics of the simulator; the chip does not count, so this is free.
void VertexStage::count_segments(int block) {
  const LaneMask of_eye = bin_block(block).segments().without(pairs_.block(block).of_light);
  for_each_lane(of_eye, num_pes(),
                [&](int pe) { ++segments_[std::size_t(first_slot(block)) + std::size_t(pe)]; });
}

void VertexStage::count_ended(int block) {
  std::vector<std::uint64_t>& paths = context_.counts.paths_by_segments;
  for_each_lane(ended_, num_pes(), [&](int pe) {
    std::uint32_t& segments = segments_[std::size_t(first_slot(block)) + std::size_t(pe)];
    if (segments >= paths.size()) paths.resize(segments + 1);
    ++paths[segments];
    segments = 0;
  });
}

void VertexStage::save(std::uint64_t step, int block) {
  const Saves from = saves(step);
  const auto scatter = [&](cn::PolySpan span, PolyField<MonoAddress> place, const LaneMask& lanes) {
    if (lanes.any()) context_.saves.copy_p2m(step, block, context_.machine.places_in(place), span, lanes);
  };
  scatter(with_tail(from.vertex, pairs_.sizes.vertex), from.vertex_place, vertices_);
  scatter(from.head.span(), from.head_place, light_vertices_);
  scatter(from.result.span(), from.result_place, result_lanes_);
  const PairContext::Block& pairs = pairs_.block(block);
  const auto save_pairs = [&](int bytes, const LaneMask& lanes) {
    context_.saves.copy_p2m(step, block, block_of(context_.layout.pair_bin, block, pairs_.sizes.pair),
                            with_tail(from.pair, bytes), lanes);
  };
  save_pairs(pairs_.sizes.pair, reached_);
  save_pairs(pairs_.sizes.pair_of_connection, pairs.occupied.without(reached_));
}

}  // namespace path_tracer
