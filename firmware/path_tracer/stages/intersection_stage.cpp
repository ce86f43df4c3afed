#include "firmware/path_tracer/stages/intersection_stage.hpp"

#include <algorithm>

#include "firmware/path_tracer/stages/surface_loads.hpp"

namespace path_tracer {

int IntersectionStage::load_bytes(const ProgramConfig& config) {
  const RecordSizes sizes(config.features);
  const int bytes = sizes.hit + sizes.surface + sizes.look_ups + sizes.path;
  const int of_candidates =
      config.resamples_lights()
          ? int{sizeof(LightResampling)} + config.light_candidates * int{sizeof(CandidateLookUp)}
          : 0;
  return config.casts_shadow_rays() ? bytes + int{sizeof(LightRecord)} + of_candidates : bytes;
}

int IntersectionStage::save_bytes(const ProgramConfig& config) {
  const int bytes = RecordSizes(config.features).scatter;
  return config.casts_shadow_rays()
             ? bytes + RecordSizes(config.features).lighting + RayStore::room_bytes(config)
             : bytes;
}

IntersectionStage::Loads IntersectionStage::loads(std::uint64_t step) const {
  BufferCutter cutter(context_.loads.buffer(step));
  Loads loads;
  const RecordSizes& sizes = context_.layout.sizes;
  loads.hit = cutter.take_bytes<HitRecord>(sizes.hit);
  loads.surface = cutter.take_bytes<SurfaceRecord>(sizes.surface);
  loads.look_ups = cutter.take_bytes<TextureLookUp>(sizes.look_ups);
  BufferCutter same_place(cutter);
  loads.path = cutter.take_bytes<PathRecord>(sizes.path);
  loads.light = cutter.take<LightRecord>();
  loads.resampling = cutter.take<LightResampling>();
  loads.candidates = cutter.take<CandidateLookUp>(context_.config.light_candidates);
  loads.lighting = same_place.take_bytes<LightingRecord>(sizes.lighting);
  return loads;
}

IntersectionStage::Saves IntersectionStage::saves(std::uint64_t step) const {
  BufferCutter cutter(context_.saves.buffer(step));
  BufferCutter same_place(cutter);
  Saves saves;
  saves.scatter = cutter.take_bytes<ScatterRecord>(context_.layout.sizes.scatter);
  saves.lighting = cutter.take_bytes<LightingRecord>(context_.layout.sizes.lighting);
  saves.shadow_ray = ray_store_.take_room(cutter);
  saves.direct_light = same_place.take<DirectLightRecord>();
  return saves;
}

cn::MonoPlaces IntersectionStage::places(SlotRecord record, std::uint64_t /*step*/, int block) {
  const Layout& layout = context_.layout;
  switch (record) {
    case SlotRecord::hit:
      return block_of(layout.intersection_bin, block, layout.sizes.hit);
    case SlotRecord::path:
      return block_of(layout.path_bin, block, layout.sizes.path);
    case SlotRecord::lighting:
    case SlotRecord::new_lighting:
      return block_of(layout.lighting_bin, block, layout.sizes.lighting);
    case SlotRecord::scatter:
      return block_of(layout.scatter_bin, block, layout.sizes.scatter);
    case SlotRecord::direct_light:
      break;
  }
  return block_of(layout.direct_light_bin, block);
}

void IntersectionStage::load(std::uint64_t step, int block) {
  context_.saves.wait_block(block);
  load_records(step, block);
}

void IntersectionStage::load_records(std::uint64_t step, int block) {
  const Loads to = loads(step);
  const Bins::Block& bin = rays(block);
  const LaneMask segments = bin.segments();
  const RecordSizes& sizes = context_.layout.sizes;
  load_slots(SlotRecord::hit, step, block, with_tail(to.hit, sizes.hit), bin.live);
  load_surfaces(context_, step, block_of_slots(block), bin, {to.hit, to.surface, to.look_ups});
  load_slots(SlotRecord::path, step, block, with_tail(to.path, sizes.path), segments);
  if (!context_.config.casts_shadow_rays()) return;
  if (!context_.config.resamples_lights())
    context_.loads.copy_m2p(step, block_of_slots(block), to.light.span(),
                            context_.machine.places_in(bin.light_place), segments);
  load_slots(SlotRecord::lighting, step, block, with_tail(to.lighting, sizes.lighting), bin.shadow);
}

void IntersectionStage::prepare(std::uint64_t step, int block) {
  if (context_.config.features.looks_up()) load_all_texels(step, block);
  if (context_.config.resamples_lights()) load_resampled_lights(step, block);
}

void IntersectionStage::load_resampled_lights(std::uint64_t step, int block) {
  const Bins::Block& bin = rays(block);
  const LaneMask hits = bin.hit_something.without(bin.shadow);
  if (!hits.any()) return;
  const Loads from = loads(step);
  LightCandidatesArguments arguments;
  arguments.hit = from.hit;
  arguments.surface = from.surface;
  arguments.path = from.path;
  arguments.light_table = read_light_table(context_.machine, context_.layout);
  arguments.lights = context_.layout.lights.address;
  arguments.candidates = context_.layout.light_candidates.address;
  arguments.sampler = context_.config.sampler;
  arguments.seed = context_.config.seed;
  arguments.count = context_.config.light_candidates;
  arguments.look_ups = from.candidates;
  arguments.resampling = from.resampling;
  arguments.light_place = bin.light_place;
  context_.loads.wait(step);
  context_.machine.run(context_.kernels.find_light_candidates, arguments, hits);
  for (int i = 0; i < arguments.count; ++i)
    context_.loads.copy_m2p(
        step, block_of_slots(block), from.candidates[i].part(&CandidateLookUp::candidate).span(),
        context_.machine.places_in(from.candidates[i].field(&CandidateLookUp::place)), hits);
  context_.loads.wait(step);
  context_.machine.run(context_.kernels.resample_light, arguments, hits);
  context_.loads.copy_m2p(step, block_of_slots(block), from.light.span(),
                          context_.machine.places_in(bin.light_place), hits);
}

void IntersectionStage::load_all_texels(std::uint64_t step, int block) {
  context_.loads.wait(step);
  const Loads from = loads(step);
  load_texels(context_, step, block_of_slots(block), rays(block), {from.hit, from.surface, from.look_ups});
  if (context_.config.features.lights.environment) load_environment(step, block);
}

void IntersectionStage::load_environment(std::uint64_t step, int block) {
  const Loads from = loads(step);
  const Bins::Block& bin = rays(block);
  const LaneMask misses = bin.live.without(bin.hit_something);
  EnvironmentLookUpArguments arguments;
  arguments.hit = from.hit;
  arguments.image = context_.layout.environment_image;
  arguments.look_up =
      PolyPointer<EnvironmentLookUp>(from.look_ups.span().offset_bytes + context_.layout.sizes.environment);
  context_.machine.run(context_.kernels.look_up_environment, arguments, misses);
  context_.loads.copy_m2p(
      step, block_of_slots(block), arguments.look_up.part(&EnvironmentLookUp::texel).span(),
      context_.machine.places_in(arguments.look_up.field(&EnvironmentLookUp::place)), misses);
}

void IntersectionStage::process(std::uint64_t step, int block) {
  process_segments(step, block);
  if (context_.config.casts_shadow_rays()) process_shadow_rays(step, block);
}

void IntersectionStage::process_segments(std::uint64_t step, int block) {
  const Loads from = loads(step);
  const Saves to = saves(step);
  Bins::Block& bin = rays(block);
  bin.casts = LaneMask{};
  ScatterArguments arguments;
  arguments.hit = from.hit;
  arguments.surface = from.surface;
  arguments.path = from.path;
  arguments.light = from.light;
  arguments.resamples_lights = context_.config.resamples_lights();
  arguments.resampling = from.resampling;
  arguments.sampler = context_.config.sampler;
  arguments.light_sampling = context_.config.light_sampling;
  arguments.seed = context_.config.seed;
  arguments.roulette_start = context_.config.roulette_start;
  arguments.max_survival = context_.config.max_survival;
  arguments.casts_shadow_rays = context_.config.casts_shadow_rays();
  arguments.cull_shadow_rays = context_.config.cull_shadow_rays;
  arguments.is_in_layers = context_.layout.layers.any;
  arguments.light_place = bin.light_place;
  arguments.lights = context_.layout.lights.address;
  arguments.scatter = to.scatter;
  arguments.shadow_ray = to.shadow_ray.ray;
  arguments.lighting = to.lighting;
  arguments.casts = &bin.casts;
  LaneMask scattered = bin.hit_something.without(bin.shadow);
  if (context_.config.features.plain()) {
    context_.machine.run(context_.kernels.scatter, arguments, bin.segments());
  } else {
    scattered = scattered.without(shade(from, arguments, bin.segments()));
  }
  if (context_.config.casts_shadow_rays())
    context_.counts.culled_shadow_rays += std::uint64_t(scattered.count() - bin.casts.count());
}

LaneMask IntersectionStage::shade(const Loads& from, const ScatterArguments& arguments,
                                  const LaneMask& segments) {
  LaneMask passes;
  ShadeArguments shading;
  static_cast<ScatterArguments&>(shading) = arguments;
  shading.features = context_.config.features;
  shading.sizes = context_.layout.sizes;
  shading.estimator = context_.config.estimator;
  shading.skips_absent_lobes = context_.config.shading != Shading::every_lobe;
  shading.environment = context_.layout.environment;
  shading.image = context_.layout.environment_image;
  shading.sun_count = context_.layout.sun_count;
  if (shading.sun_count > 0)
    shading.suns = context_.machine.read_mono(context_.layout.suns, std::size_t(shading.sun_count));
  shading.look_ups = from.look_ups;
  shading.passes = &passes;
  LobeUse lobe_use;
  shading.lobe_use = &lobe_use;
  context_.machine.run(context_.kernels.shade, shading, segments);
  if (segments.any())
    count_lobes(lobe_use, shading.features.lobes, shading.skips_absent_lobes, context_.machine.num_pes(),
                context_.counts.lobes);
  return passes;
}

void IntersectionStage::process_shadow_rays(std::uint64_t step, int block) {
  const Loads from = loads(step);
  const Saves to = saves(step);
  Bins::Block& bin = rays(block);
  LaneMask goes_on;
  IlluminateArguments arguments;
  arguments.hit = from.hit;
  arguments.surface = from.surface;
  arguments.lighting = from.lighting;
  arguments.is_in_layers = context_.layout.layers.any;
  arguments.features = context_.config.features;
  arguments.sizes = context_.layout.sizes;
  arguments.look_ups = from.look_ups;
  arguments.direct_light = to.direct_light;
  arguments.sampler = context_.config.sampler;
  arguments.seed = context_.config.seed;
  arguments.shadow_ray = to.shadow_ray.ray;
  arguments.goes_on = &goes_on;
  context_.machine.run(context_.kernels.illuminate, arguments, bin.shadow);
  bin.casts = bin.casts.with(goes_on);
}

void IntersectionStage::save(std::uint64_t step, int block) {
  const Saves from = saves(step);
  const Bins::Block& bin = rays(block);
  save_slots(SlotRecord::scatter, step, block, with_tail(from.scatter, context_.layout.sizes.scatter),
             bin.segments());
  if (!context_.config.casts_shadow_rays()) return;
  ray_store_.save(context_.saves, step, slots(step, block), from.shadow_ray, bin.light_place, bin.casts);
  // A shadow ray that goes on has its record there already, and has found no light yet.
  save_slots(SlotRecord::new_lighting, step, block, with_tail(from.lighting, context_.layout.sizes.lighting),
             bin.casts.without(bin.shadow));
  save_slots(SlotRecord::direct_light, step, block, from.direct_light.span(), bin.ended_shadow());
}

}  // namespace path_tracer
